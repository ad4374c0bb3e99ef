//! Embree 3 or 4, loaded when the bench runs: single rays, scenes with the flag `ROBUST`.

use std::ffi::{CString, c_char, c_void};
use std::mem::ManuallyDrop;
use std::sync::atomic::{AtomicIsize, Ordering};
use std::time::Instant;

use bidir_accel::{Isa, Ray};
use glam::DAffine3;
use libloading::Library;

use crate::ours::Engine;
use crate::rays::Question;
use crate::scenes::{Mesh, Scene};

/// An object of Embree.
type Handle = *mut c_void;

/// `RTCRay`, the same in both versions.
#[repr(C, align(16))]
#[derive(Clone, Copy)]
struct RtcRay {
    origin: [f32; 3],
    t_near: f32,
    direction: [f32; 3],
    time: f32,
    t_far: f32,
    mask: u32,
    id: u32,
    flags: u32,
}

/// `RTCRayHit`: version 4 has one word more of what was hit, and both end before `_room` does.
#[repr(C, align(16))]
struct RtcRayHit {
    ray: RtcRay,
    normal: [f32; 3],
    uv: [f32; 2],
    primitive: u32,
    geometry: u32,
    instances: [u32; 2],
    _room: [u32; 7],
}

/// `RTCIntersectContext` of version 3: flags, filter, instances; larger than any build has it.
#[repr(C, align(16))]
struct RtcContext([u32; 16]);

const NOTHING: u32 = u32::MAX;
const CONTEXT: RtcContext =
    RtcContext([0, 0, 0, 0, NOTHING, NOTHING, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]);

/// Values of Embree's enumerations.
const TRIANGLES: u32 = 0;
const INSTANCE: u32 = 121;
const INDICES: u32 = 0;
const VERTICES: u32 = 1;
const UINT3: u32 = 0x5003;
const FLOAT3: u32 = 0x9003;
const FLOAT3X4_COLUMN_MAJOR: u32 = 0x9234;
const ROBUST: u32 = 4;
const VERSION_MAJOR: u32 = 1;

/// A loaded library.
pub(crate) struct Embree {
    /// Never unloaded: threads of it may still run.
    library: ManuallyDrop<Library>,
    version: [isize; 3],
}

impl Embree {
    /// The library that `BIDIR_EMBREE` names, or one of a usual name. `Err` tells what was tried.
    pub(crate) fn load() -> Result<Self, String> {
        let names = match std::env::var("BIDIR_EMBREE") {
            Ok(path) => vec![path],
            Err(_) => [
                "libembree4.so.4",
                "libembree4.so",
                "libembree3.so.3",
                "libembree3.so",
            ]
            .map(str::to_owned)
            .to_vec(),
        };
        let mut failures = Vec::new();
        for name in &names {
            // SAFETY: what Embree and its libraries do when they are loaded is start no thread and touch
            // nothing of ours; that the name is Embree's is for the user to see to.
            match unsafe { Library::new(name) } {
                Ok(library) => return Self::with_version(library),
                Err(error) => failures.push(error.to_string()),
            }
        }
        Err(format!(
            "no Embree ({}); set BIDIR_EMBREE to its path",
            failures.join("; ")
        ))
    }

    fn with_version(library: Library) -> Result<Self, String> {
        let mut embree = Self {
            library: ManuallyDrop::new(library),
            version: [0; 3],
        };
        let device = embree.device(Isa::Sse2, 1)?;
        let property: extern "C" fn(Handle, u32) -> isize = embree.function("rtcGetDeviceProperty");
        embree.version = [0, 1, 2].map(|part| property(device, VERSION_MAJOR + part));
        embree.release("rtcReleaseDevice", device);
        match embree.version[0] {
            3 | 4 => Ok(embree),
            other => Err(format!("Embree {other}: only 3 and 4 are known")),
        }
    }

    pub(crate) fn version(&self) -> String {
        self.version.map(|part| part.to_string()).join(".")
    }

    /// The function of this name.
    fn function<T: Copy>(&self, name: &str) -> T {
        // SAFETY: all callers ask for the type that the headers of Embree 3 and 4 declare.
        unsafe {
            *self
                .library
                .get::<T>(name.as_bytes())
                .expect("a function of Embree")
        }
    }

    fn release(&self, name: &str, handle: Handle) {
        let release: extern "C" fn(Handle) = self.function(name);
        release(handle);
    }

    /// A device that builds with so many threads, and uses no more than these instructions.
    fn device(&self, isa: Isa, threads: usize) -> Result<Handle, String> {
        let settings = format!("threads={threads},set_affinity=0,isa={isa}");
        let settings = CString::new(settings).expect("no zero");
        let new: extern "C" fn(*const c_char) -> Handle = self.function("rtcNewDevice");
        let device = new(settings.as_ptr());
        if device.is_null() {
            return Err(format!("Embree has no device for {isa}"));
        }
        Ok(device)
    }

    fn check(&self, device: Handle) -> Result<(), String> {
        let error: extern "C" fn(Handle) -> u32 = self.function("rtcGetDeviceError");
        match error(device) {
            0 => Ok(()),
            code => Err(format!("Embree's error {code}")),
        }
    }

    /// Builds a scene for these instructions on so many threads.
    pub(crate) fn build(
        &self,
        scene: &Scene,
        isa: Isa,
        threads: usize,
    ) -> Result<EmbreeScene<'_>, String> {
        let device = self.device(isa, threads)?;
        BYTES.store(0, Ordering::Relaxed);
        let monitor: extern "C" fn(Handle, Monitor, Handle) =
            self.function("rtcSetDeviceMemoryMonitorFunction");
        monitor(device, count_bytes, std::ptr::null_mut());
        let mut built = EmbreeScene {
            embree: self,
            device,
            scenes: Vec::new(),
            buffers: Vec::new(),
            calls: Calls::new(self),
            seconds: 0.0,
            bytes: 0,
        };
        let begin = Instant::now();
        let top = built.new_scene();
        built.attach_mesh(top, &scene.mesh);
        if let Some((mesh, maps)) = &scene.object {
            let object = built.new_scene();
            built.attach_mesh(object, mesh);
            built.commit(object);
            maps.iter()
                .for_each(|map| built.attach_instance(top, object, map));
        }
        built.commit(top);
        built.seconds = begin.elapsed().as_secs_f64();
        built.bytes = BYTES.load(Ordering::Relaxed) as usize;
        self.check(device)?;
        Ok(built)
    }
}

/// What Embree has allocated; scenes are built one after another.
static BYTES: AtomicIsize = AtomicIsize::new(0);

type Monitor = extern "C" fn(Handle, isize, bool) -> bool;

extern "C" fn count_bytes(_: Handle, bytes: isize, _after: bool) -> bool {
    BYTES.fetch_add(bytes, Ordering::Relaxed);
    true
}

/// The functions that trace. The context of version 4 may be null.
enum Calls {
    V3 {
        intersect: extern "C" fn(Handle, *mut RtcContext, *mut RtcRayHit),
        occluded: extern "C" fn(Handle, *mut RtcContext, *mut RtcRay),
    },
    V4 {
        intersect: extern "C" fn(Handle, *mut RtcRayHit, *mut c_void),
        occluded: extern "C" fn(Handle, *mut RtcRay, *mut c_void),
    },
}

impl Calls {
    fn new(embree: &Embree) -> Self {
        if embree.version[0] == 3 {
            Self::V3 {
                intersect: embree.function("rtcIntersect1"),
                occluded: embree.function("rtcOccluded1"),
            }
        } else {
            Self::V4 {
                intersect: embree.function("rtcIntersect1"),
                occluded: embree.function("rtcOccluded1"),
            }
        }
    }
}

/// A scene that is built.
pub(crate) struct EmbreeScene<'a> {
    embree: &'a Embree,
    device: Handle,
    /// The first is what rays are traced in.
    scenes: Vec<Handle>,
    /// What geometries refer to: Embree reads a little beyond the end.
    buffers: Vec<(Vec<f32>, Vec<u32>)>,
    calls: Calls,
    seconds: f64,
    bytes: usize,
}

// SAFETY: any number of threads may trace in a committed scene, and nothing else is done to it until it is
// dropped.
unsafe impl Sync for EmbreeScene<'_> {}

impl EmbreeScene<'_> {
    fn new_scene(&mut self) -> Handle {
        let new: extern "C" fn(Handle) -> Handle = self.embree.function("rtcNewScene");
        let flags: extern "C" fn(Handle, u32) = self.embree.function("rtcSetSceneFlags");
        let scene = new(self.device);
        flags(scene, ROBUST);
        self.scenes.push(scene);
        scene
    }

    fn commit(&self, scene: Handle) {
        self.embree.release("rtcCommitScene", scene);
    }

    fn attach(&self, scene: Handle, geometry: Handle) {
        self.embree.release("rtcCommitGeometry", geometry);
        let attach: extern "C" fn(Handle, Handle) -> u32 =
            self.embree.function("rtcAttachGeometry");
        attach(scene, geometry);
        self.embree.release("rtcReleaseGeometry", geometry);
    }

    fn attach_mesh(&mut self, scene: Handle, mesh: &Mesh) {
        type Share = extern "C" fn(Handle, u32, u32, u32, *const c_void, usize, usize, usize);
        let mut vertices: Vec<f32> = mesh.vertices.iter().flat_map(|v| v.to_array()).collect();
        vertices.extend([0.0; 4]);
        let indices = mesh.faces.concat();
        let new: extern "C" fn(Handle, u32) -> Handle = self.embree.function("rtcNewGeometry");
        let share: Share = self.embree.function("rtcSetSharedGeometryBuffer");
        let geometry = new(self.device, TRIANGLES);
        let (v, i) = (vertices.as_ptr().cast(), indices.as_ptr().cast());
        share(geometry, VERTICES, 0, FLOAT3, v, 0, 12, mesh.vertices.len());
        share(geometry, INDICES, 0, UINT3, i, 0, 12, mesh.faces.len());
        self.attach(scene, geometry);
        self.buffers.push((vertices, indices));
    }

    fn attach_instance(&self, scene: Handle, object: Handle, map: &DAffine3) {
        let new: extern "C" fn(Handle, u32) -> Handle = self.embree.function("rtcNewGeometry");
        let of: extern "C" fn(Handle, Handle) =
            self.embree.function("rtcSetGeometryInstancedScene");
        let place: extern "C" fn(Handle, u32, u32, *const f32) =
            self.embree.function("rtcSetGeometryTransform");
        let geometry = new(self.device, INSTANCE);
        of(geometry, object);
        let columns = map.to_cols_array().map(|x| x as f32);
        place(geometry, 0, FLOAT3X4_COLUMN_MAJOR, columns.as_ptr());
        self.attach(scene, geometry);
    }

    fn intersect(&self, ray: &Ray) -> bool {
        let mut hit = RtcRayHit {
            ray: rtc_ray(ray),
            normal: [0.0; 3],
            uv: [0.0; 2],
            primitive: NOTHING,
            geometry: NOTHING,
            instances: [NOTHING; 2],
            _room: [NOTHING; 7],
        };
        match self.calls {
            Calls::V3 { intersect, .. } => intersect(self.scenes[0], &mut { CONTEXT }, &mut hit),
            Calls::V4 { intersect, .. } => {
                intersect(self.scenes[0], &mut hit, std::ptr::null_mut());
            }
        }
        std::hint::black_box((
            hit.ray.t_far,
            hit.normal,
            hit.uv,
            hit.primitive,
            hit.instances,
        ));
        hit.geometry != NOTHING
    }

    fn occluded(&self, ray: &Ray) -> bool {
        let mut ray = rtc_ray(ray);
        match self.calls {
            Calls::V3 { occluded, .. } => occluded(self.scenes[0], &mut { CONTEXT }, &mut ray),
            Calls::V4 { occluded, .. } => occluded(self.scenes[0], &mut ray, std::ptr::null_mut()),
        }
        ray.t_far < 0.0
    }
}

fn rtc_ray(ray: &Ray) -> RtcRay {
    RtcRay {
        origin: ray.origin.to_array(),
        t_near: ray.t_min,
        direction: ray.direction.to_array(),
        time: 0.0,
        t_far: ray.t_max,
        mask: u32::MAX,
        id: 0,
        flags: 0,
    }
}

impl Engine for EmbreeScene<'_> {
    fn count_hits(&self, question: Question, rays: &[Ray]) -> usize {
        let hits = |ray: &&Ray| match question {
            Question::Closest => self.intersect(ray),
            Question::Occluded => self.occluded(ray),
        };
        rays.iter().filter(hits).count()
    }

    fn bytes(&self) -> usize {
        self.bytes
    }

    fn build_seconds(&self) -> f64 {
        self.seconds
    }
}

impl Drop for EmbreeScene<'_> {
    fn drop(&mut self) {
        for &scene in &self.scenes {
            self.embree.release("rtcReleaseScene", scene);
        }
        self.embree.release("rtcReleaseDevice", self.device);
    }
}

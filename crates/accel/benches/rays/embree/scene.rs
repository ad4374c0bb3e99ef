//! A scene of Embree's, and its rays.

use std::ffi::c_void;
use std::sync::atomic::{AtomicIsize, Ordering};
use std::time::Instant;

use bidir_accel::{Isa, Ray};
use glam::{DAffine3, Vec3};

use super::single::Calls;
use super::{Embree, Handle};
use crate::ours::Engine;
use crate::rays::Question;
use crate::scenes::{Mesh, Scene};

/// Values of Embree's enumerations.
const TRIANGLES: u32 = 0;
const INSTANCE: u32 = 121;
const INDICES: u32 = 0;
const VERTICES: u32 = 1;
const UINT3: u32 = 0x5003;
const FLOAT3: u32 = 0x9003;
const FLOAT3X4_COLUMN_MAJOR: u32 = 0x9234;
const ROBUST: u32 = 4;

impl Embree {
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
            for map in maps {
                built.attach_instance(top, object, map);
            }
        }
        built.commit(top);
        built.seconds = begin.elapsed().as_secs_f64();
        built.bytes = BYTES.load(Ordering::Relaxed) as usize;
        self.check(device)?;
        Ok(built)
    }
}

/// Bytes that Embree has allocated; scenes are built one after another.
static BYTES: AtomicIsize = AtomicIsize::new(0);

type Monitor = extern "C" fn(Handle, isize, bool) -> bool;

extern "C" fn count_bytes(_: Handle, bytes: isize, _after: bool) -> bool {
    BYTES.fetch_add(bytes, Ordering::Relaxed);
    true
}

/// A scene that is built.
pub(crate) struct EmbreeScene<'a> {
    embree: &'a Embree,
    device: Handle,
    /// The first is what rays are traced in.
    scenes: Vec<Handle>,
    /// The buffers that geometries refer to: Embree reads a little beyond the end.
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
        let mut vertices: Vec<f32> = mesh.vertices.iter().flat_map(Vec3::to_array).collect();
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
}

impl Engine for EmbreeScene<'_> {
    fn count_hits(&self, question: Question, rays: &[Ray]) -> usize {
        let hits = |ray: &&Ray| match question {
            Question::Closest => self.calls.intersect(self.scenes[0], ray),
            Question::Occluded | Question::Together => self.calls.occluded(self.scenes[0], ray),
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

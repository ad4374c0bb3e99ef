//! Single rays, as the two versions take them.

use std::ffi::c_void;

use bidir_accel::Ray;

use super::{Embree, Handle};

/// `RTCRay`, the same in both versions.
#[repr(C, align(16))]
#[derive(Clone, Copy)]
pub(super) struct RtcRay {
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
pub(super) struct RtcRayHit {
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
pub(super) struct RtcContext([u32; 16]);

const NOTHING: u32 = u32::MAX;
const CONTEXT: RtcContext =
    RtcContext([0, 0, 0, 0, NOTHING, NOTHING, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]);

/// The functions that trace. The context of version 4 may be null.
pub(super) enum Calls {
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
    /// The calls of the library's version.
    pub(super) fn new(embree: &Embree) -> Self {
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

    /// Finds the hit of the ray. True if there is one.
    pub(super) fn intersect(&self, scene: Handle, ray: &Ray) -> bool {
        let mut hit = RtcRayHit {
            ray: rtc_ray(ray),
            normal: [0.0; 3],
            uv: [0.0; 2],
            primitive: NOTHING,
            geometry: NOTHING,
            instances: [NOTHING; 2],
            _room: [NOTHING; 7],
        };
        let mut context = CONTEXT;
        match self {
            Calls::V3 { intersect, .. } => intersect(scene, &raw mut context, &raw mut hit),
            Calls::V4 { intersect, .. } => {
                intersect(scene, &raw mut hit, std::ptr::null_mut());
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

    /// True if anything is in the way.
    pub(super) fn occluded(&self, scene: Handle, ray: &Ray) -> bool {
        let mut ray = rtc_ray(ray);
        let mut context = CONTEXT;
        match self {
            Calls::V3 { occluded, .. } => occluded(scene, &raw mut context, &raw mut ray),
            Calls::V4 { occluded, .. } => occluded(scene, &raw mut ray, std::ptr::null_mut()),
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

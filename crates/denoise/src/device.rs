//! The library's objects, so that they can be used without `unsafe`.

use crate::error::DenoiseError;
use crate::ffi::{Api, CPU, FLOAT3, Handle, NO_ERROR};
use crate::find::Found;
use std::ffi::{CStr, c_int};
use std::ptr;

/// What a filter calls an image, and the image.
pub(crate) struct Image<'a> {
    pub(crate) name: &'static CStr,
    /// Shape: the size that is given to [`Device::filter`].
    pub(crate) pixels: &'a mut [[f32; 3]],
}

/// A device of the library: the processor.
#[derive(Debug)]
pub(crate) struct Device {
    api: Api,
    /// A device that was made by `api`, and is released by dropping this alone.
    handle: Handle,
}

impl Device {
    /// A device with at most `threads` threads; 0 leaves that to the library.
    pub(crate) fn new(found: &Found, threads: usize) -> Result<Self, DenoiseError> {
        let api = Api::of(found)?;
        // SAFETY: the function has no other argument.
        let handle = unsafe { (api.new_device)(CPU) };
        let device = Self { api, handle };
        if handle.is_null() {
            device.check()?;
            return Err(silent());
        }
        if device.version()[0] != 2 {
            return Err(DenoiseError::Version {
                file: found.file.clone(),
                version: device.version().map(|part| part.to_string()).join("."),
            });
        }
        let threads = c_int::try_from(threads).unwrap_or(c_int::MAX);
        // SAFETY: the device is there, names end with a zero and are not kept.
        unsafe {
            (api.set_device_int)(handle, c"numThreads".as_ptr(), threads);
            // Pinned threads would get in the way of a render in the same process.
            (api.set_device_bool)(handle, c"setAffinity".as_ptr(), false);
            (api.commit_device)(handle);
        }
        device.check()?;
        Ok(device)
    }

    /// Major, minor and patch version of the library.
    pub(crate) fn version(&self) -> [c_int; 3] {
        [c"versionMajor", c"versionMinor", c"versionPatch"].map(|name| {
            // SAFETY: the device is there, and the name ends with a zero and is not kept.
            unsafe { (self.api.get_device_int)(self.handle, name.as_ptr()) }
        })
    }

    /// Denoises `image` in place, guided by `guides`; `flags` are switched on.
    ///
    /// Panics: where [`Filter::set_image`] does.
    pub(crate) fn filter(
        &self,
        size: [usize; 2],
        image: &mut Image<'_>,
        guides: &mut [Image<'_>],
        flags: &[&CStr],
    ) -> Result<(), DenoiseError> {
        let filter = Filter::new(self)?;
        filter.set_image(&[c"output", image.name], size, image.pixels);
        for guide in guides {
            filter.set_image(&[guide.name], size, guide.pixels);
        }
        for flag in flags {
            // SAFETY: the filter is there, and the name ends with a zero and is not kept.
            unsafe { (self.api.set_filter_bool)(filter.handle, flag.as_ptr(), true) };
        }
        // SAFETY: the filter is there. It reads and writes the images that were set, which are
        // borrowed until this function returns, and which nobody else uses. The image and the output
        // may be the same. The filter is released before the images are given back.
        unsafe {
            (self.api.commit_filter)(filter.handle);
            (self.api.execute_filter)(filter.handle);
        }
        self.check()
    }

    /// Fails where the library met an error since the last call.
    fn check(&self) -> Result<(), DenoiseError> {
        let mut message = ptr::null();
        // SAFETY: the device is there, or null, which asks why there is none.
        let error = unsafe { (self.api.get_device_error)(self.handle, &raw mut message) };
        if error == NO_ERROR {
            return Ok(());
        }
        if message.is_null() {
            return Err(silent());
        }
        // SAFETY: it ends with a zero, and stays until the next call for an error.
        let message = unsafe { CStr::from_ptr(message) };
        Err(DenoiseError::Library {
            message: message.to_string_lossy().into_owned(),
        })
    }
}

impl Drop for Device {
    fn drop(&mut self) {
        if !self.handle.is_null() {
            // SAFETY: the device is there, and nothing uses it any more.
            unsafe { (self.api.release_device)(self.handle) };
        }
    }
}

/// A filter of the kind `RT`, made for images of ray tracing.
struct Filter<'d> {
    device: &'d Device,
    /// A filter that was made by the device, and is released by dropping this alone.
    handle: Handle,
}

impl<'d> Filter<'d> {
    fn new(device: &'d Device) -> Result<Self, DenoiseError> {
        // SAFETY: the device is there, and the name ends with a zero and is not kept.
        let handle = unsafe { (device.api.new_filter)(device.handle, c"RT".as_ptr()) };
        if handle.is_null() {
            device.check()?;
            return Err(silent());
        }
        Ok(Self { device, handle })
    }

    /// Tells the filter where the image of these names is; whoever executes the filter has to hold
    /// it until then. Panics: its shape is not `size`, or a side does not fit into 31 bits.
    fn set_image(&self, names: &[&CStr], size: [usize; 2], pixels: &mut [[f32; 3]]) {
        let [width, height] = size;
        assert_eq!(width * height, pixels.len(), "the shape is the size");
        assert!(c_int::try_from(width.max(height)).is_ok(), "sides fit");
        let pixels = pixels.as_mut_ptr().cast();
        let set_image = self.device.api.set_image;
        for name in names {
            let name = name.as_ptr();
            // SAFETY: the filter is there, the name ends with a zero and is not kept, and from the
            // first pixel on there are width · height triples of f32 without gaps.
            unsafe { set_image(self.handle, name, pixels, FLOAT3, width, height, 0, 0, 0) };
        }
    }
}

impl Drop for Filter<'_> {
    fn drop(&mut self) {
        // SAFETY: the filter is there, and nothing uses it any more.
        unsafe { (self.device.api.release_filter)(self.handle) };
    }
}

/// An error of which the library says nothing.
fn silent() -> DenoiseError {
    DenoiseError::Library {
        message: "an error without a message".to_owned(),
    }
}

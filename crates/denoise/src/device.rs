//! A safe interface to the library's objects.

use crate::error::DenoiseError;
use crate::ffi::{Api, CPU, FLOAT3, Handle, NO_ERROR};
use crate::find::Found;
use std::ffi::{CStr, c_int};
use std::ptr;

/// An image, with its name in a filter.
pub(crate) struct Image<'a> {
    pub(crate) name: &'static CStr,
    /// Shape: the `size` passed to [`Device::filter`].
    pub(crate) pixels: &'a mut [[f32; 3]],
}

/// A device of the library: the processor.
#[derive(Debug)]
pub(crate) struct Device {
    api: Api,
    /// A device made by `api`; only dropping this releases it.
    handle: Handle,
}

impl Device {
    /// Creates a device with at most `threads` threads; 0 leaves the number to the library.
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
        // SAFETY: the device is valid; the names are null-terminated, and the library does not keep them.
        unsafe {
            (api.set_device_int)(handle, c"numThreads".as_ptr(), threads);
            // Pinned threads would disturb a render in the same process.
            (api.set_device_bool)(handle, c"setAffinity".as_ptr(), false);
            (api.commit_device)(handle);
        }
        device.check()?;
        Ok(device)
    }

    /// Returns major, minor and patch version of the library.
    pub(crate) fn version(&self) -> [c_int; 3] {
        [c"versionMajor", c"versionMinor", c"versionPatch"].map(|name| {
            // SAFETY: the device is valid; the name is null-terminated, and the library does not keep it.
            unsafe { (self.api.get_device_int)(self.handle, name.as_ptr()) }
        })
    }

    /// Denoises `image` in place, guided by `guides`, with `flags` switched on.
    ///
    /// Panics: as [`Filter::set_image`].
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
            // SAFETY: the filter is valid; the name is null-terminated, and the library does not keep it.
            unsafe { (self.api.set_filter_bool)(filter.handle, flag.as_ptr(), true) };
        }
        // SAFETY: the filter is valid. It reads and writes the images set above, which this function
        // borrows exclusively until it returns. Input and output may be the same image. The filter is
        // released before the borrows end.
        unsafe {
            (self.api.commit_filter)(filter.handle);
            (self.api.execute_filter)(filter.handle);
        }
        self.check()
    }

    /// Returns the library's first error since the last call, if any.
    fn check(&self) -> Result<(), DenoiseError> {
        let mut message = ptr::null();
        // SAFETY: the device is valid, or null, for the error of creating it.
        let error = unsafe { (self.api.get_device_error)(self.handle, &raw mut message) };
        if error == NO_ERROR {
            return Ok(());
        }
        if message.is_null() {
            return Err(silent());
        }
        // SAFETY: the message is null-terminated, and valid until the next call for an error.
        let message = unsafe { CStr::from_ptr(message) };
        Err(DenoiseError::Library {
            message: message.to_string_lossy().into_owned(),
        })
    }
}

impl Drop for Device {
    fn drop(&mut self) {
        if !self.handle.is_null() {
            // SAFETY: the device is valid and no longer used.
            unsafe { (self.api.release_device)(self.handle) };
        }
    }
}

/// A filter of type `RT`, for ray-traced images.
struct Filter<'d> {
    device: &'d Device,
    /// A filter made by the device; only dropping this releases it.
    handle: Handle,
}

impl<'d> Filter<'d> {
    fn new(device: &'d Device) -> Result<Self, DenoiseError> {
        // SAFETY: the device is valid; the name is null-terminated, and the library does not keep it.
        let handle = unsafe { (device.api.new_filter)(device.handle, c"RT".as_ptr()) };
        if handle.is_null() {
            device.check()?;
            return Err(silent());
        }
        Ok(Self { device, handle })
    }

    /// Sets the image of these names; the caller must keep it borrowed while the filter executes.
    ///
    /// Panics: its shape is not `size`, or a side does not fit into 31 bits.
    fn set_image(&self, names: &[&CStr], size: [usize; 2], pixels: &mut [[f32; 3]]) {
        let [width, height] = size;
        assert_eq!(width * height, pixels.len(), "the shape is the size");
        assert!(c_int::try_from(width.max(height)).is_ok(), "sides fit");
        let pixels = pixels.as_mut_ptr().cast();
        let set_image = self.device.api.set_image;
        for name in names {
            let name = name.as_ptr();
            // SAFETY: the filter is valid; the name is null-terminated, and the library does not keep it;
            // `pixels` points to width · height contiguous triples of f32.
            unsafe { set_image(self.handle, name, pixels, FLOAT3, width, height, 0, 0, 0) };
        }
    }
}

impl Drop for Filter<'_> {
    fn drop(&mut self) {
        // SAFETY: the filter is valid and no longer used.
        unsafe { (self.device.api.release_filter)(self.handle) };
    }
}

/// Returns the error for a failure that the library does not explain.
fn silent() -> DenoiseError {
    DenoiseError::Library {
        message: "an error without a message".to_owned(),
    }
}

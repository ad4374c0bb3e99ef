//! Bindings to the C functions in use, as declared in `oidn.h` of version 2.

use crate::error::DenoiseError;
use crate::find::Found;
use libloading::Library;
use std::ffi::{c_char, c_int, c_void};

/// A device or a filter of the library.
pub(crate) type Handle = *mut c_void;

/// `OIDN_DEVICE_TYPE_CPU`.
pub(crate) const CPU: c_int = 1;
/// `OIDN_FORMAT_FLOAT3`.
pub(crate) const FLOAT3: c_int = 3;
/// `OIDN_ERROR_NONE`.
pub(crate) const NO_ERROR: c_int = 0;

type SetImage = unsafe extern "C" fn(
    Handle,
    *const c_char,
    *mut c_void,
    c_int,
    usize,
    usize,
    usize,
    usize,
    usize,
);

/// The library's functions. The library is never unloaded, so that the pointers stay valid.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Api {
    /// `oidnNewDevice(type)`; null on failure.
    pub(crate) new_device: unsafe extern "C" fn(c_int) -> Handle,
    /// `oidnReleaseDevice(device)`.
    pub(crate) release_device: unsafe extern "C" fn(Handle),
    /// `oidnCommitDevice(device)`, after its settings and before its use.
    pub(crate) commit_device: unsafe extern "C" fn(Handle),
    /// `oidnSetDeviceBool(device, name, value)`.
    pub(crate) set_device_bool: unsafe extern "C" fn(Handle, *const c_char, bool),
    /// `oidnSetDeviceInt(device, name, value)`.
    pub(crate) set_device_int: unsafe extern "C" fn(Handle, *const c_char, c_int),
    /// `oidnGetDeviceInt(device, name)`.
    pub(crate) get_device_int: unsafe extern "C" fn(Handle, *const c_char) -> c_int,
    /// `oidnGetDeviceError(device, message)` takes the first error of this thread since the last
    /// call; for a null device, the error of creating it.
    pub(crate) get_device_error: unsafe extern "C" fn(Handle, *mut *const c_char) -> c_int,
    /// `oidnNewFilter(device, type)`; null on failure.
    pub(crate) new_filter: unsafe extern "C" fn(Handle, *const c_char) -> Handle,
    /// `oidnReleaseFilter(filter)`.
    pub(crate) release_filter: unsafe extern "C" fn(Handle),
    /// `oidnSetSharedFilterImage(filter, name, pixels, format, width, height, offset, pixel stride,
    /// row stride)`; strides of 0 mean contiguous pixels.
    pub(crate) set_image: SetImage,
    /// `oidnSetFilterBool(filter, name, value)`.
    pub(crate) set_filter_bool: unsafe extern "C" fn(Handle, *const c_char, bool),
    /// `oidnCommitFilter(filter)`, after its settings and before its use.
    pub(crate) commit_filter: unsafe extern "C" fn(Handle),
    /// `oidnExecuteFilter(filter)`, which returns when the output is complete.
    pub(crate) execute_filter: unsafe extern "C" fn(Handle),
}

impl Api {
    /// Looks up all functions. Errors: one is missing.
    pub(crate) fn of(found: &Found) -> Result<Self, DenoiseError> {
        check_not_first_version(found)?;
        let unusable = |function: &str| DenoiseError::Unusable {
            file: found.file.clone(),
            reason: format!("it has no function {function}"),
        };
        // SAFETY: the types of the fields equal the declarations in `oidn.h`, and the library stays
        // loaded.
        let api = unsafe {
            let library = found.library;
            Self {
                new_device: function(library, "oidnNewDevice").map_err(unusable)?,
                release_device: function(library, "oidnReleaseDevice").map_err(unusable)?,
                commit_device: function(library, "oidnCommitDevice").map_err(unusable)?,
                set_device_bool: function(library, "oidnSetDeviceBool").map_err(unusable)?,
                set_device_int: function(library, "oidnSetDeviceInt").map_err(unusable)?,
                get_device_int: function(library, "oidnGetDeviceInt").map_err(unusable)?,
                get_device_error: function(library, "oidnGetDeviceError").map_err(unusable)?,
                new_filter: function(library, "oidnNewFilter").map_err(unusable)?,
                release_filter: function(library, "oidnReleaseFilter").map_err(unusable)?,
                set_image: function(library, "oidnSetSharedFilterImage").map_err(unusable)?,
                set_filter_bool: function(library, "oidnSetFilterBool").map_err(unusable)?,
                commit_filter: function(library, "oidnCommitFilter").map_err(unusable)?,
                execute_filter: function(library, "oidnExecuteFilter").map_err(unusable)?,
            }
        };
        Ok(api)
    }
}

/// Refuses version 1, which is recognized by its older names of functions.
fn check_not_first_version(found: &Found) -> Result<(), DenoiseError> {
    let has = |name: &str| {
        // SAFETY: the address is not used.
        unsafe { function::<*const c_void>(found.library, name) }.is_ok()
    };
    if has("oidnGetDevice1i") && !has("oidnGetDeviceInt") {
        return Err(DenoiseError::Version {
            file: found.file.clone(),
            version: "1".to_owned(),
        });
    }
    Ok(())
}

/// Looks up a function. Errors: its name, if it is missing.
///
/// # Safety
///
/// `F` is a pointer to a function with the arguments and result of the function of this name.
unsafe fn function<'n, F: Copy>(library: &'static Library, name: &'n str) -> Result<F, &'n str> {
    // SAFETY: by the caller's promise.
    let symbol = unsafe { library.get::<F>(name.as_bytes()) };
    symbol.map(|symbol| *symbol).map_err(|_| name)
}

//! Embree 3 or 4, loaded when the bench runs: single rays, scenes with the flag `ROBUST`.

use std::ffi::{CString, OsStr, c_char, c_void};
use std::mem::ManuallyDrop;

use bidir_accel::Isa;
use libloading::Library;

mod scene;
mod single;

/// An object of Embree.
type Handle = *mut c_void;

/// `RTC_DEVICE_PROPERTY_VERSION_MAJOR`; the next two are the other parts.
const VERSION_MAJOR: u32 = 1;

/// A loaded library.
pub(crate) struct Embree {
    /// Never unloaded: threads of it may still run.
    library: ManuallyDrop<Library>,
    version: [isize; 3],
}

impl Embree {
    /// The libraries that `BIDIR_EMBREE` names, divided as in `PATH`, or one of a usual name. `Err` lists
    /// the names tried.
    pub(crate) fn load() -> Vec<Result<Self, String>> {
        match std::env::var_os("BIDIR_EMBREE") {
            Some(paths) => std::env::split_paths(&paths)
                .map(|path| Self::open(path.as_os_str()))
                .collect(),
            None => vec![Self::with_usual_name()],
        }
    }

    fn with_usual_name() -> Result<Self, String> {
        let names = [
            "libembree4.so.4",
            "libembree4.so",
            "libembree3.so.3",
            "libembree3.so",
        ];
        let mut failures = Vec::new();
        for name in names {
            match Self::open(name.as_ref()) {
                Ok(embree) => return Ok(embree),
                Err(failure) => failures.push(failure),
            }
        }
        Err(format!(
            "no Embree ({}); set BIDIR_EMBREE to its path",
            failures.join("; ")
        ))
    }

    fn open(name: &OsStr) -> Result<Self, String> {
        // SAFETY: Embree and its libraries start no thread when they are loaded, and touch nothing of
        // ours; that the name is Embree's is for the user to see to.
        let library = unsafe { Library::new(name) };
        let reason = |error| format!("{}: {error}", name.display());
        Self::with_version(library.map_err(reason)?)
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
}

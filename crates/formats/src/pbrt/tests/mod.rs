mod errors;
mod good;
mod robust;

//! Allocation of memory whose size depends on the resolution, which users choose: the system may refuse it.

use super::FilmError;

/// Returns `count` values, each made by `make`.
///
/// Errors: the system does not have the memory.
pub fn filled<T>(count: usize, make: impl FnMut() -> T) -> Result<Vec<T>, FilmError> {
    let mut values = Vec::new();
    let reserved = values.try_reserve_exact(count);
    reserved.map_err(|_| FilmError::NoMemory {
        bytes: (count as u64).saturating_mul(size_of::<T>() as u64),
    })?;
    values.resize_with(count, make);
    Ok(values)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_that_no_system_has_is_refused() {
        assert_eq!(filled(3, || 7).unwrap(), [7; 3]);
        let error = filled(1 << 57, || 0_i128).unwrap_err();
        assert_eq!(error, FilmError::NoMemory { bytes: 1 << 61 });
        let text = error.to_string();
        assert!(text.contains(" 2305843009213693952 bytes "), "{text}");
    }
}

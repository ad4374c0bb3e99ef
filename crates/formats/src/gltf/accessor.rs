//! Accessors: arrays of numbers in buffers, of any component type, interleaved, normalised or sparse.

use super::document::Document;
use super::json::Accessor;
use super::place::{GltfFault, Place};
use crate::error::ErrorKind;
use crate::limits::MOST_ZEROS;
use crate::scalar::Scalar;
use std::ops::Range;

/// Returns the type of component of a code.
fn component(code: u32, place: &Place) -> Result<Scalar, GltfFault> {
    Ok(match code {
        5120 => Scalar::I8,
        5121 => Scalar::U8,
        5122 => Scalar::I16,
        5123 => Scalar::U16,
        5125 => Scalar::U32,
        5126 => Scalar::F32,
        _ => {
            let place = place.key("componentType");
            return Err(place.scene(format!("{code} is not a component type")));
        }
    })
}

/// Maps a normalised integer to `[0, 1]` or `[-1, 1]`.
fn normalise(component: Scalar, value: f64) -> f64 {
    match component {
        Scalar::I8 => (value / 127.0).max(-1.0),
        Scalar::U8 => value / 255.0,
        Scalar::I16 => (value / 32767.0).max(-1.0),
        Scalar::U16 => value / 65535.0,
        _ => value,
    }
}

/// The types of values by name, each with its number of components.
const KINDS: [(&str, usize); 7] = [
    ("SCALAR", 1),
    ("VEC2", 2),
    ("VEC3", 3),
    ("VEC4", 4),
    ("MAT2", 4),
    ("MAT3", 9),
    ("MAT4", 16),
];

/// An accessor that is checked against its buffers.
struct Layout<'a> {
    accessor: &'a Accessor,
    component: Scalar,
    components: usize,
    place: Place,
}

impl<'a> Layout<'a> {
    fn new(document: &'a Document, index: usize, user: &Place) -> Result<Self, GltfFault> {
        let accessor = user.find(&document.root.accessors, index, "accessor")?;
        let place = Place::of("accessors", index);
        let known = KINDS.iter().find(|(name, _)| *name == accessor.kind);
        let Some(&(_, components)) = known else {
            let (kind, place) = (&accessor.kind, place.key("type"));
            let fault = place.scene(format!("`{kind}` is not an accessor type"));
            return Err(fault.with_nearest(kind, KINDS.map(|(name, _)| name)));
        };
        let component = component(accessor.component_type, &place)?;
        Ok(Self {
            accessor,
            component,
            components,
            place,
        })
    }

    /// Returns the size of one value in bytes. Columns of matrices begin at multiples of four bytes.
    fn value_size(&self) -> usize {
        self.offset_of(self.components - 1) + self.component.size()
    }

    /// Returns the offset of a component within its value. Unit: bytes.
    fn offset_of(&self, i: usize) -> usize {
        let rows = match self.accessor.kind.as_str() {
            "MAT2" => 2,
            "MAT3" => 3,
            _ => return i * self.component.size(),
        };
        let column = (rows * self.component.size()).next_multiple_of(4);
        (i / rows) * column + (i % rows) * self.component.size()
    }

    /// Reads all components of all values.
    fn read(&self, document: &Document) -> Result<Vec<f64>, GltfFault> {
        let count = self.accessor.count;
        let components = count.saturating_mul(self.components);
        let mut values = match self.accessor.buffer_view {
            Some(view) => self.read_dense(document, view)?,
            None if components > MOST_ZEROS => {
                let message = format!(
                    "{count} elements of zeros exceed the limit of {MOST_ZEROS} components"
                );
                return Err(self.place.fault(ErrorKind::Limit, message));
            }
            None => {
                document.count_components(components, &self.place)?;
                vec![0.0; components]
            }
        };
        self.read_sparse(document, &mut values)?;
        if self.accessor.normalized {
            for value in &mut values {
                *value = normalise(self.component, *value);
            }
        }
        Ok(values)
    }

    fn read_dense(&self, document: &Document, view: usize) -> Result<Vec<f64>, GltfFault> {
        let place = self.place.key("bufferView");
        let (bytes, stride) = document.view(view, &place)?;
        let size = self.value_size();
        let alignment = if self.components > 4 { 4 } else { 1 };
        let stride = stride.unwrap_or(size.next_multiple_of(alignment));
        let elements = Elements {
            offset: self.accessor.byte_offset,
            stride,
            size,
            count: self.accessor.count,
        };
        let range = elements.range(bytes.len(), &self.place)?;
        let bytes = &bytes[range];
        document.count_components(self.accessor.count * self.components, &self.place)?;
        let values = (0..self.accessor.count).map(|i| &bytes[i * stride..i * stride + size]);
        Ok(values.flat_map(|value| self.numbers(value)).collect())
    }

    /// Returns the components of one value.
    fn numbers(&self, value: &[u8]) -> impl Iterator<Item = f64> {
        let components = (0..self.components).map(|i| &value[self.offset_of(i)..]);
        components.map(|component| self.component.read(component).unwrap_or_default())
    }

    fn read_sparse(&self, document: &Document, values: &mut [f64]) -> Result<(), GltfFault> {
        let Some(sparse) = &self.accessor.sparse else {
            return Ok(());
        };
        let place = self.place.key("sparse");
        let indices_place = place.key("indices");
        let (indices, values_view) = (&sparse.indices, &sparse.values);
        let component = component(indices.component_type, &indices_place)?;
        let (index_bytes, _) = document.view(indices.buffer_view, &indices_place)?;
        let (value_bytes, _) = document.view(values_view.buffer_view, &place.key("values"))?;
        let of_indices = Elements::packed(indices.byte_offset, component.size(), sparse.count);
        let of_values = Elements::packed(values_view.byte_offset, self.value_size(), sparse.count);
        let index_bytes = &index_bytes[of_indices.range(index_bytes.len(), &indices_place)?];
        let value_bytes = &value_bytes[of_values.range(value_bytes.len(), &place.key("values"))?];
        let replaced = index_bytes
            .chunks_exact(component.size())
            .zip(value_bytes.chunks_exact(self.value_size()));
        for (index, value) in replaced {
            let index = component.read(index).unwrap_or_default() as usize;
            if index >= self.accessor.count {
                let count = self.accessor.count;
                let message = format!("index {index} is not below the count of {count}");
                return Err(indices_place.scene(message));
            }
            let replaced = values[index * self.components..].iter_mut();
            replaced
                .zip(self.numbers(value))
                .for_each(|(old, new)| *old = new);
        }
        Ok(())
    }
}

/// The layout of values in a buffer view.
struct Elements {
    offset: usize,
    stride: usize,
    size: usize,
    count: usize,
}

impl Elements {
    fn packed(offset: usize, size: usize, count: usize) -> Self {
        Self {
            offset,
            stride: size,
            size,
            count,
        }
    }

    /// Returns the range of bytes of all values. Errors: it ends beyond `available`.
    fn range(&self, available: usize, place: &Place) -> Result<Range<usize>, GltfFault> {
        let end = || {
            let last = self.count.checked_sub(1)?.checked_mul(self.stride)?;
            self.offset.checked_add(last)?.checked_add(self.size)
        };
        if self.count == 0 {
            return Ok(0..0);
        }
        if self.stride < self.size {
            let message = format!(
                "values of {} bytes are {} bytes apart",
                self.size, self.stride
            );
            return Err(place.scene(message));
        }
        match end() {
            Some(end) if end <= available => Ok(self.offset..end),
            _ => {
                let Self {
                    offset,
                    count,
                    size,
                    ..
                } = self;
                let message = format!(
                    "{count} values of {size} bytes from byte {offset} end beyond the \
                     {available} bytes available"
                );
                let fault = place.fault(ErrorKind::Data, message);
                Err(fault.with_hint("the file is cut or its counts are wrong"))
            }
        }
    }
}

impl Document {
    /// Reads an accessor of vectors with `N` components, which `user` refers to.
    pub(super) fn vectors<const N: usize>(
        &self,
        index: usize,
        user: &Place,
    ) -> Result<Vec<[f32; N]>, GltfFault> {
        let layout = Layout::new(self, index, user)?;
        if layout.components != N {
            let kind = &layout.accessor.kind;
            let message =
                format!("accessor {index} is a {kind}, which does not have {N} components");
            return Err(user.scene(message));
        }
        let values = layout.read(self)?;
        let vector = |value: &[f64; N]| value.map(|component| component as f32);
        Ok(values.as_chunks::<N>().0.iter().map(vector).collect())
    }

    /// Reads an accessor of vectors with `N` components. Errors: a component is not finite.
    pub(super) fn finite_vectors<const N: usize>(
        &self,
        index: usize,
        user: &Place,
    ) -> Result<Vec<[f32; N]>, GltfFault> {
        let vectors = self.vectors::<N>(index, user)?;
        let is_finite = |vector: &[f32; N]| vector.iter().all(|component| component.is_finite());
        match vectors.iter().position(|vector| !is_finite(vector)) {
            None => Ok(vectors),
            Some(i) => Err(user.scene(format!("value {i} of accessor {index} is not finite"))),
        }
    }

    /// Returns the number of components of an accessor's vectors.
    pub(super) fn components(&self, index: usize, user: &Place) -> Result<usize, GltfFault> {
        Layout::new(self, index, user).map(|layout| layout.components)
    }

    /// Reads an accessor of whole numbers.
    pub(super) fn indices(&self, index: usize, user: &Place) -> Result<Vec<u32>, GltfFault> {
        let layout = Layout::new(self, index, user)?;
        let whole = matches!(layout.component, Scalar::U8 | Scalar::U16 | Scalar::U32);
        if layout.components != 1 || !whole {
            let message = format!("accessor {index} has no indices, which are unsigned scalars");
            return Err(user.scene(message));
        }
        let values = layout.read(self)?.into_iter();
        Ok(values.map(|value| value as u32).collect())
    }
}

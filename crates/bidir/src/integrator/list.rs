//! Lists that are written in place, one or many in one memory.

use std::ops::Deref;

/// A list whose memory is overwritten rather than cleared: values are written behind its end without a branch, whether
/// they stay or not.
#[derive(Clone, Debug, Default)]
pub struct List<T> {
    /// The values, and room behind them.
    memory: Vec<T>,
    len: usize,
}

impl<T: Copy + Default> List<T> {
    /// Forgets all values, and keeps the memory.
    pub fn clear(&mut self) {
        self.len = 0;
    }

    /// Makes room for `count` values more.
    #[inline]
    pub fn make_room(&mut self, count: usize) {
        let needed = self.len + count;
        if self.memory.len() < needed {
            self.memory.resize(needed, T::default());
        }
    }

    /// Writes `value` behind the end, where there is room, and moves the end by `step`: 1 if it stays, 0 if the next
    /// one takes its place.
    #[inline]
    pub fn write(&mut self, value: T, step: usize) {
        self.memory[self.len] = value;
        self.len += step;
    }

    /// Has `write` write up to `count` values behind the end, and keeps as many of the first as it returns.
    #[inline(always)]
    pub fn write_some(&mut self, count: usize, write: impl FnOnce(&mut [T]) -> usize) {
        self.make_room(count);
        self.len += write(&mut self.memory[self.len..][..count]);
    }
}

impl<T> Deref for List<T> {
    type Target = [T];

    #[inline]
    fn deref(&self) -> &[T] {
        &self.memory[..self.len]
    }
}

impl<'a, T> IntoIterator for &'a List<T> {
    type Item = &'a T;
    type IntoIter = std::slice::Iter<'a, T>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

/// Lists that follow each other in one memory.
#[derive(Debug, Default)]
pub struct Lists<T> {
    values: List<T>,
    /// The end of each list.
    ends: Vec<usize>,
}

impl<T: Copy + Default> Lists<T> {
    /// Forgets all lists, and keeps the memory.
    pub fn clear(&mut self) {
        self.values.clear();
        self.ends.clear();
    }

    /// Returns the values of all lists, the last of which is still written.
    #[inline]
    pub fn open(&mut self) -> &mut List<T> {
        &mut self.values
    }

    /// Ends a list; what is written from here on is in the next one.
    #[inline]
    pub fn close(&mut self) {
        self.ends.push(self.values.len());
    }
}

impl<T> Lists<T> {
    /// Returns where list number `i` begins among all values.
    #[inline]
    pub fn begin(&self, i: usize) -> usize {
        if i == 0 { 0 } else { self.ends[i - 1] }
    }

    /// Returns list number `i`; an empty one where none was closed.
    #[inline]
    pub fn get(&self, i: usize) -> &[T] {
        let Some(&end) = self.ends.get(i) else {
            return &[];
        };
        &self.values[self.begin(i)..end]
    }
}

impl<T> Deref for Lists<T> {
    type Target = [T];

    #[inline]
    fn deref(&self) -> &[T] {
        &self.values
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_stay_if_the_end_moves() {
        let mut list = List::default();
        for _ in 0..2 {
            list.clear();
            list.make_room(3);
            for (value, step) in [(1, 1), (2, 0), (3, 1), (4, 0)] {
                list.write(value, step);
            }
            assert_eq!(*list, [1, 3]);
            list.write_some(2, |room| {
                room.copy_from_slice(&[5, 6]);
                1
            });
            assert_eq!(*list, [1, 3, 5]);
        }
    }

    #[test]
    fn lists_follow_each_other() {
        let mut lists = Lists::default();
        for value in 0..3 {
            lists.open().make_room(1);
            lists.open().write(value, usize::from(value != 1));
            lists.close();
        }
        let lists: [&[i32]; 4] = std::array::from_fn(|i| lists.get(i));
        assert_eq!(lists, [&[0][..], &[], &[2], &[]]);
    }
}

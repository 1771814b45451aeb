//! Gaussian elimination of a sparse matrix whose pattern is known when the crate is compiled.
//!
//! The order of elimination and every single operation are worked out in constant evaluation. At run time nothing
//! is left of the bookkeeping: each operation is one multiplication and subtraction at a fixed place.

use super::elementary::fused;
use super::graph::{LinkPorts, Node};

/// Largest number of nodes.
pub const MAXIMUM_NODES: usize = 22;

/// Largest number of matrix entries that are not always zero.
pub(super) const MAXIMUM_ENTRIES: usize = 64;

/// Largest number of operations of a list, that of [`unrolled`].
pub const MAXIMUM_OPERATIONS: usize = 96;

const ABSENT: u8 = u8::MAX;

/// Calls an associated function that is generic over a number with 0 to 95, so that each call knows its number when compiled.
#[doc(hidden)]
#[macro_export]
macro_rules! unrolled {
    ($function:ident $arguments:tt) => {
        $crate::unrolled!(@ $function $arguments
            0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25 26 27 28 29 30 31
            32 33 34 35 36 37 38 39 40 41 42 43 44 45 46 47 48 49 50 51 52 53 54 55 56 57 58 59 60 61 62 63
            64 65 66 67 68 69 70 71 72 73 74 75 76 77 78 79 80 81 82 83 84 85 86 87 88 89 90 91 92 93 94 95)
    };
    (@ $function:ident $arguments:tt $($number:literal)*) => {
        $( Self::$function::<$number> $arguments; )*
    };
}

/// One operation; places are entries of the matrix or nodes of a right-hand side.
#[derive(Debug, Clone, Copy)]
pub(super) enum Operation {
    /// Nothing, beyond the end of a list.
    None,
    /// `target = 1 / target`.
    Invert { target: u8 },
    /// `target *= factor`.
    Scale { target: u8, factor: u8 },
    /// `target -= factor * source`.
    Subtract { target: u8, factor: u8, source: u8 },
}

impl Operation {
    /// Applies it to matrix entries.
    #[inline(always)]
    pub fn apply_to_matrix(self, entries: &mut [f64; MAXIMUM_ENTRIES]) {
        match self {
            Self::None => {}
            Self::Invert { target } => entries[target as usize] = entries[target as usize].recip(),
            Self::Scale { target, factor } => entries[target as usize] *= entries[factor as usize],
            Self::Subtract { target, factor, source } => {
                entries[target as usize] =
                    fused(-entries[factor as usize], entries[source as usize], entries[target as usize]);
            }
        }
    }

    /// Applies it to a right-hand side; factors are matrix entries.
    #[inline(always)]
    pub fn apply_to_vector(self, entries: &[f64; MAXIMUM_ENTRIES], vector: &mut [f64; MAXIMUM_NODES]) {
        match self {
            Self::None | Self::Invert { .. } => {}
            Self::Scale { target, factor } => vector[target as usize] *= entries[factor as usize],
            Self::Subtract { target, factor, source } => {
                vector[target as usize] =
                    fused(-entries[factor as usize], vector[source as usize], vector[target as usize]);
            }
        }
    }
}

/// Operations in the order in which they are applied.
#[derive(Debug, Clone, Copy)]
pub(super) struct Operations {
    list: [Operation; MAXIMUM_OPERATIONS],
    length: usize,
}

impl Operations {
    const EMPTY: Self = Self { list: [Operation::None; MAXIMUM_OPERATIONS], length: 0 };

    const fn push(&mut self, operation: Operation) {
        assert!(self.length < MAXIMUM_OPERATIONS, "too many operations of elimination");
        self.list[self.length] = operation;
        self.length += 1;
    }

    /// Operation at a position; none beyond the end.
    pub const fn at(&self, position: usize) -> Operation {
        self.list[position]
    }
}

type Pattern = [[bool; MAXIMUM_NODES]; MAXIMUM_NODES];

/// Everything that can be known about the elimination before the numbers are.
#[derive(Debug, Clone, Copy)]
pub(super) struct Elimination {
    places: [[u8; MAXIMUM_NODES]; MAXIMUM_NODES],
    /// Turns the matrix into its factors, diagonal inverted.
    pub factorise: Operations,
    /// Solves with the lower factor.
    pub forward: Operations,
    /// Solves with the upper factor, the nodes known first at the beginning.
    pub backward: Operations,
}

impl Elimination {
    /// Place of an entry of the matrix.
    #[inline(always)]
    pub const fn entry(&self, row: usize, column: usize) -> usize {
        self.places[row][column] as usize
    }

    /// Works out the elimination of a network.
    pub const fn of(nodes: usize, links: &[LinkPorts], known_first: &[Node]) -> Self {
        assert!(nodes <= MAXIMUM_NODES, "too many thermal nodes");
        let mut filled = pattern(nodes, links);
        let order = order(nodes, &mut filled, known_first);
        let places = places(nodes, &filled);
        let mut result = Self {
            places,
            factorise: Operations::EMPTY,
            forward: Operations::EMPTY,
            backward: Operations::EMPTY,
        };
        let mut position = 0;
        while position < nodes {
            result.add_pivot(&filled, &order, position, nodes);
            position += 1;
        }
        while position > 0 {
            position -= 1;
            result.add_back_substitution(&filled, &order, position, nodes);
        }
        result
    }

    const fn add_pivot(
        &mut self,
        filled: &Pattern,
        order: &[usize; MAXIMUM_NODES],
        position: usize,
        nodes: usize,
    ) {
        let k = order[position];
        let pivot = self.places[k][k];
        self.factorise.push(Operation::Invert { target: pivot });
        let mut row = position + 1;
        while row < nodes {
            let i = order[row];
            row += 1;
            if !filled[i][k] {
                continue;
            }
            let factor = self.places[i][k];
            self.factorise.push(Operation::Scale { target: factor, factor: pivot });
            self.forward.push(Operation::Subtract { target: i as u8, factor, source: k as u8 });
            let mut column = position + 1;
            while column < nodes {
                let j = order[column];
                column += 1;
                if filled[k][j] {
                    let (target, source) = (self.places[i][j], self.places[k][j]);
                    self.factorise.push(Operation::Subtract { target, factor, source });
                }
            }
        }
    }

    const fn add_back_substitution(
        &mut self,
        filled: &Pattern,
        order: &[usize; MAXIMUM_NODES],
        position: usize,
        nodes: usize,
    ) {
        let k = order[position];
        let mut column = nodes;
        while column > position + 1 {
            column -= 1;
            let j = order[column];
            if filled[k][j] {
                let factor = self.places[k][j];
                self.backward.push(Operation::Subtract { target: k as u8, factor, source: j as u8 });
            }
        }
        self.backward.push(Operation::Scale { target: k as u8, factor: self.places[k][k] });
    }
}

/// Entries that links bring into the matrix, and its diagonal.
const fn pattern(nodes: usize, links: &[LinkPorts]) -> Pattern {
    let mut filled = [[false; MAXIMUM_NODES]; MAXIMUM_NODES];
    let mut i = 0;
    while i < nodes {
        filled[i][i] = true;
        i += 1;
    }
    let mut link = 0;
    while link < links.len() {
        let (rows, columns) = ([links[link].loses, links[link].gains], [links[link].hot, links[link].cold]);
        let mut pair = 0;
        while pair < 4 {
            if let (Some(row), Some(column)) = (rows[pair / 2], columns[pair % 2]) {
                filled[row.index()][column.index()] = true;
            }
            pair += 1;
        }
        link += 1;
    }
    filled
}

/// Pivots in order of least fill (Markowitz), those known first at the end; enters the fill into the pattern.
const fn order(nodes: usize, filled: &mut Pattern, known_first: &[Node]) -> [usize; MAXIMUM_NODES] {
    let mut order = [0; MAXIMUM_NODES];
    let mut done = [false; MAXIMUM_NODES];
    let mut position = 0;
    while position < nodes {
        let left = nodes - position;
        let k = if left <= known_first.len() {
            known_first[left - 1].index()
        } else {
            cheapest(nodes, filled, &done, known_first)
        };
        done[k] = true;
        order[position] = k;
        position += 1;
        let mut entry = 0;
        while entry < nodes * nodes {
            let (i, j) = (entry / nodes, entry % nodes);
            if !done[i] && !done[j] && filled[i][k] && filled[k][j] {
                filled[i][j] = true;
            }
            entry += 1;
        }
    }
    order
}

/// The pivot that causes the fewest operations, among those left that may come early.
const fn cheapest(
    nodes: usize,
    filled: &Pattern,
    done: &[bool; MAXIMUM_NODES],
    known_first: &[Node],
) -> usize {
    let mut best = (usize::MAX, 0);
    let mut k = 0;
    while k < nodes {
        let mut late = done[k];
        let mut member = 0;
        while member < known_first.len() {
            late |= known_first[member].index() == k;
            member += 1;
        }
        let (mut rows, mut columns) = (0, 0);
        let mut i = 0;
        while i < nodes {
            rows += (i != k && !done[i] && filled[i][k]) as usize;
            columns += (i != k && !done[i] && filled[k][i]) as usize;
            i += 1;
        }
        if !late && rows * columns < best.0 {
            best = (rows * columns, k);
        }
        k += 1;
    }
    best.1
}

/// Numbers the entries that are not always zero.
const fn places(nodes: usize, filled: &Pattern) -> [[u8; MAXIMUM_NODES]; MAXIMUM_NODES] {
    let mut places = [[ABSENT; MAXIMUM_NODES]; MAXIMUM_NODES];
    let (mut next, mut entry) = (0, 0);
    while entry < nodes * nodes {
        let (i, j) = (entry / nodes, entry % nodes);
        if filled[i][j] {
            assert!(next < MAXIMUM_ENTRIES, "too many thermal links");
            places[i][j] = next as u8;
            next += 1;
        }
        entry += 1;
    }
    places
}

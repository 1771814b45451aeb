//! Values of all flows of a step; which there are stands in the architecture's layout.

pub use crate::architecture::flows::{Crossing, Flow, FlowRow};
use crate::architecture::layout::FLOW_PLACES;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::ops::{Index, IndexMut};

/// One value for each flow [W]; those that a vehicle does not have are 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flows([f64; FLOW_PLACES]);

impl Default for Flows {
    fn default() -> Self {
        Self([0.0; FLOW_PLACES])
    }
}

/// Without the zeros at the end.
impl Serialize for Flows {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let used = self.0.iter().rposition(|&flow| flow != 0.0).map_or(0, |last| last + 1);
        self.0[..used].serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Flows {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let values = Vec::<f64>::deserialize(deserializer)?;
        let mut flows = Self::default();
        let Some(used) = flows.0.get_mut(..values.len()) else {
            return Err(D::Error::custom(format!("{} flows, but there are {FLOW_PLACES}", values.len())));
        };
        used.copy_from_slice(&values);
        Ok(flows)
    }
}

impl Index<Flow> for Flows {
    type Output = f64;
    #[inline(always)]
    fn index(&self, flow: Flow) -> &f64 {
        &self.0[flow.index()]
    }
}

impl IndexMut<Flow> for Flows {
    #[inline(always)]
    fn index_mut(&mut self, flow: Flow) -> &mut f64 {
        &mut self.0[flow.index()]
    }
}

impl Flows {
    /// Sets the first so many flows to 0.
    #[inline(always)]
    pub fn clear(&mut self, count: usize) {
        for flow in 0..count.next_multiple_of(4).min(FLOW_PLACES) {
            self.0[flow] = 0.0;
        }
    }

    /// Adds another set of flows with a weight.
    #[inline]
    pub fn accumulate(&mut self, other: &Self, weight: f64) {
        for (mine, theirs) in self.0.iter_mut().zip(&other.0) {
            *mine += weight * theirs;
        }
    }

    /// Values by place.
    #[must_use]
    pub fn values(&self) -> &[f64; FLOW_PLACES] {
        &self.0
    }

    /// Sum of some of the flows [W].
    #[must_use]
    #[inline]
    pub fn sum_w(&self, flows: &[Flow]) -> f64 {
        match flows {
            [first, others @ ..] => others.iter().fold(self[*first], |sum, &flow| sum + self[flow]),
            [] => 0.0,
        }
    }
}

//! Shapes of the built-in architectures, as the build script reads them from `configs/architectures`.
#![allow(missing_docs, unused_braces, unused_imports, reason = "written by the build script")]

use super::compiled::Wiring;
use crate::architecture::declaration::Level::{Condensing, Evaporating};
use crate::architecture::flows::Flow;
use crate::architecture::indices::{
    BranchIndices, ExchangerIndices, FrontEndIndices, HeaterIndices, Indices, LoopIndices,
};
use crate::architecture::layout::CabinLayout;
use crate::architecture::wiring::{HeatSource, Inlet, Link, SeriesPlace};
use crate::numerics::thermal_network::{LinkPorts, Node};

include!(concat!(env!("OUT_DIR"), "/built_in_shapes.rs"));

//! What is in a layer: walls, skin, infill, adhesion and seams.
//!
//! In: the outlines of a layer and of the layers around it, their heights, and
//! plans: the plain numbers that a module needs of the settings. Each module's
//! `plan.rs` reads the settings; no other file takes all of them. Out: areas of a
//! layer's plane, and the [`Bead`]s that fill them, not yet in any order.
//!
//! | module | what it answers |
//! |---|---|
//! | [`view`] | what is around a layer |
//! | [`resolution`] | how many points a stroke needs |
//! | [`cover`] | which part of an area other areas cover |
//! | [`outline`] | what is changed in the outline before all else |
//! | [`walls`], [`fuzzy`] | where walls lie and how they are printed: overhangs, interlocked beads, texture |
//! | [`exposure`] | which area inside the walls is skin, and which is sparse |
//! | [`floating`] | islands that begin on nothing |
//! | [`skin`] | the lines that close tops and bottoms, and the bridges |
//! | [`infill`] | the pattern inside |
//! | [`adhesion`] | skirt, brim and ears |
//! | [`seam`] | where loops may begin |
//!
//! Guarantees: the same input gives the same beads, on any number of threads.
//! Distances are those of the layer's plane, not values of the field.
//!
//! Not known here: the order of beads, travels, speeds, and G-code.
//!
//! [`Bead`]: isoslice_planar::bead::Bead

#![warn(unreachable_pub)]

pub mod adhesion;
pub mod cover;
pub mod exposure;
pub mod floating;
pub mod fuzzy;
pub mod infill;
pub mod outline;
pub mod resolution;
pub mod seam;
pub mod skin;
pub mod view;
pub mod walls;

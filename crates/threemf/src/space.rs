//! Where names of elements are from: the core specification, or an extension.

/// A namespace.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Space {
    /// The core specification. Names without a namespace count as its own.
    Core,
    /// Objects in other files of the archive.
    Production,
    /// Colours and materials, which do not change the shape.
    Material,
    /// Names for sets of triangles.
    TriangleSets,
    /// Beam lattices.
    Beams,
    /// Balls of beam lattices.
    Balls,
    /// Level sets, stacks of pictures, and data inside bodies.
    Volumetric,
    /// Functions of nodes.
    Implicit,
    /// Any other one.
    Other,
    /// That of a prefix which is not declared.
    Undeclared,
}

/// The ends of the namespaces.
const KNOWN: [(&str, Space); 8] = [
    ("/core/2015/02", Space::Core),
    ("/production/2015/06", Space::Production),
    ("/material/2015/02", Space::Material),
    ("/trianglesets/2021/07", Space::TriangleSets),
    ("/beamlattice/2017/02", Space::Beams),
    ("/beamlattice/balls/2020/07", Space::Balls),
    ("/volumetric/2022/01", Space::Volumetric),
    ("/implicit/2023/12", Space::Implicit),
];

impl Space {
    pub(crate) fn of(namespace: &str) -> Space {
        let named = KNOWN.iter().find(|(end, _)| namespace.ends_with(end));
        named.map_or(Space::Other, |(_, space)| *space)
    }
}

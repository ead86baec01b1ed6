// SPDX-License-Identifier: GPL-2.0-or-later
// Where cables, and spheres that knots carry, are near to other bodies: geometry, the functors that find it, the law
// that leaves it to the CableEngine.
#pragma once

#include "CableElement.hpp"
#include "CarriedSphere.hpp"
#include "HollarsPhys.hpp"
#include "Sheave.hpp"

#include <core/Dispatching.hpp>
#include <pkg/common/Box.hpp>
#include <pkg/common/Facet.hpp>
#include <pkg/common/Wall.hpp>
#include <pkg/dem/DemXDofGeom.hpp>

namespace yade {

// The body's shape as a solid that cables touch, where the body is; false if it has none.
bool solidOf(ancf_solid& solid, const Body& body);

class CableGeom : public GenericSpheresContact {
public:
    bool ball = false;   // whether the first body is a sphere; set where places are found
    bool edited = false; // from outside, so that its lists did not fit; its engine tells
    // Takes the places as found now; friction of those that were there before is kept.
    void set(const ancf_nearest* found, int n);
    bool fits() const; // one value for each place, in all lists
    // Whether a place is the mean of several.
    bool lies(size_t i) const { return share[i] != 1; }

    // clang-format off
    YADE_CLASS_BASE_DOC_ATTRS_CTOR(CableGeom, GenericSpheresContact,
        "Places where a body and a :yref:`CableElement` (the second), or a :yref:`CarriedSphere`, touch or will within the "
        "step. normal and contactPoint are those of the smallest gap.",
        ((vector<int>, segment, , Attr::readonly, "Segments of the element, one for each place."))
        ((vector<Real>, xi, , Attr::readonly, "Places on the element, 0 to 1; where a segment lies along the body, the mean of those that hold it."))
        ((vector<Real>, gap, , Attr::readonly, "Gaps between the surfaces, negative where they overlap [m]."))
        ((vector<Vector3r>, point, , Attr::readonly, "Places on the centreline; centre of the sphere [m]."))
        ((vector<Vector3r>, normals, , Attr::readonly, "Unit vectors from the first body to the second."))
        ((vector<Real>, force, , Attr::readonly, "Normal forces in the last step [N]."))
        ((vector<Vector3r>, friction, , Attr::readonly, "Forces of friction on the second body in the last step [N]."))
        ((vector<Real>, owed, , Attr::hidden, "Work that the contacts did too much, and give back [J]."))
        ((vector<Vector3r>, late, , Attr::hidden, "Impulses of the last step, each part times the time from its start to it [N s²]."))
        ((vector<Vector3r>, powers, , Attr::hidden, "Means of ξ, ξ² and ξ³ over the places that hold a segment."))
        ((vector<Vector3r>, powersLast, , Attr::hidden, "Those of the last step."))
        ((vector<Real>, share, , Attr::hidden, "Depth that a law is about by that of the place.")),
        createIndex();
    )
    // clang-format on
    REGISTER_CLASS_INDEX(CableGeom, GenericSpheresContact)
};
REGISTER_SERIALIZABLE(CableGeom);

// clang-format off
#define ANCF_IG2(first, second, doc)                                                                                   \
    class Ig2_##first##_##second##_CableGeom : public IGeomFunctor {                                                   \
    public:                                                                                                            \
        bool go(const shared_ptr<Shape>&, const shared_ptr<Shape>&, const State&, const State&, const Vector3r&,       \
                const bool&, const shared_ptr<Interaction>&) override;                                                 \
        FUNCTOR2D(first, second)                                                                                       \
        DEFINE_FUNCTOR_ORDER_2D(first, second)                                                                         \
        YADE_CLASS_BASE_DOC(Ig2_##first##_##second##_CableGeom, IGeomFunctor, doc)                                     \
    };                                                                                                                 \
    REGISTER_SERIALIZABLE(Ig2_##first##_##second##_CableGeom)

ANCF_IG2(Sphere, CableElement, "Places of a cable on the true curve that are nearest to a sphere.");
ANCF_IG2(Box, CableElement, "Places of a cable on the true curve that are nearest to a box, its edges and corners included.");
ANCF_IG2(Facet, CableElement, "Places of a cable on the true curve that are nearest to a facet, on either side.");
ANCF_IG2(Wall, CableElement, "Places of a cable on the true curve that are nearest to a wall.");
ANCF_IG2(Sheave, CableElement, "Places of a cable on the true curve that are nearest to the groove of a :yref:`Sheave`.");
ANCF_IG2(Sphere, CarriedSphere, "Contact of a sphere with one that a knot carries, seen before they touch.");
ANCF_IG2(Box, CarriedSphere, "Contact of a box with a sphere that a knot carries, seen before they touch.");
ANCF_IG2(Facet, CarriedSphere, "Contact of a facet with a sphere that a knot carries, seen before they touch.");
ANCF_IG2(Wall, CarriedSphere, "Contact of a wall with a sphere that a knot carries, seen before they touch.");
ANCF_IG2(Sheave, CarriedSphere, "Contact of a :yref:`Sheave` with a sphere that a knot carries, seen before they touch.");
// clang-format on

class Law2_CableGeom_HollarsPhys_Hollars : public LawFunctor {
public:
    bool go(shared_ptr<IGeom>&, shared_ptr<IPhys>&, Interaction*) override;
    // Python would take any name for a new attribute: AttributeError.
    static void setAttribute(const py::object& self, const string& name, const py::object& value);
    FUNCTOR2D(CableGeom, HollarsPhys)
    // clang-format off
    YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(Law2_CableGeom_HollarsPhys_Hollars, LawFunctor,
        "Leaves the contacts of cables, and of what their knots carry, to their :yref:`CableEngine`, which solves them "
        "together in sub-steps by its own normal and friction; ends those that are out of reach.",
        ,
        ,
        .def("__setattr__", &Law2_CableGeom_HollarsPhys_Hollars::setAttribute)
    )
    // clang-format on
};
REGISTER_SERIALIZABLE(Law2_CableGeom_HollarsPhys_Hollars);

} // namespace yade

// SPDX-License-Identifier: GPL-2.0-or-later
// A sheave: a wheel with a groove, turning about its own z axis; its bound, its contact and its picture.
#pragma once

#include <core/Dispatching.hpp>
#include <pkg/common/GLDrawFunctors.hpp>
#include <pkg/common/Sphere.hpp>

extern "C" {
#include "ancf/sheave.h"
}

namespace yade {

class Sheave : public Shape {
    ancf_groove form {};

public:
    const ancf_groove& groove() const { return form; }
    // Axis of a body at an orientation. What is aligned with an axis of the scene is so to the last bit: a planar
    // scene stays planar.
    static Vector3r axisOf(const Quaternionr& ori);
    void postLoad(Sheave&);
    Real opening() const { return 2 * ancf_groove_opening(&form); }
    Real overallWidth() const { return 2 * ancf_groove_half_width(&form); }
    Real rimRadius() const { return form.radius + form.height; }
    Real fillet() const { return form.fillet; }
    py::tuple touch(const Vector3r& place, Real ballRadius) const;
    vector<Vector2r> outline() const; // (z, radius) of the section from side to side [m]
    py::list pyOutline() const;

    // clang-format off
    YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(Sheave, Shape,
        "Wheel with a groove, a body of revolution about the body's z axis. Touches spheres and cables without facets.",
        ((Real, radius, .05, Attr::triggerPostLoad, "Radius at the bottom of the groove [m]."))
        ((Real, width, .01, Attr::triggerPostLoad, "Width of the groove between its lips [m]."))
        ((string, profile, "round", Attr::triggerPostLoad, "'round' (a circular bottom), 'flat' (with flanges if flangeHeight is above 0) or 'vee'."))
        ((Real, grooveRadius, 0, Attr::triggerPostLoad, "Radius of the bottom of a round groove, between bottom and flange of a flat one, in the tip of a vee [m]; 0: width/2, the smaller of flangeHeight and width/4, width/6."))
        ((Real, grooveAngle, M_PI / 4, Attr::triggerPostLoad, "Angle between the walls of a vee [rad]."))
        ((Real, flangeHeight, 0, Attr::triggerPostLoad, "Height of the lips above the bottom [m]; 0: none on a flat sheave, the end of the arc on a round one. That of a vee follows from its width."))
        ((Real, flangeThickness, 0, Attr::triggerPostLoad, "Width of the rim beyond each lip [m]; 0: width/4, none on a flat sheave without flanges.")),
        createIndex(); postLoad(*this);,
        .add_property("opening", &Sheave::opening, "Width between the lips [m].")
        .add_property("overallWidth", &Sheave::overallWidth, "Width with both rims [m].")
        .add_property("rimRadius", &Sheave::rimRadius, "Radius at the lips [m].")
        .add_property("fillet", &Sheave::fillet, "Radius of the groove's bottom, or between bottom and flange [m].")
        .def("touch", &Sheave::touch, (py::arg("place"), py::arg("radius")), "(depth [m], normal) of a ball whose centre is at `place` in the sheave's frame.")
        .def("outline", &Sheave::pyOutline, "Its section from the axis on one side, over the groove, to the axis on the other: list of (z, radius) [m].")
    )
    // clang-format on
    REGISTER_CLASS_INDEX(Sheave, Shape)
};
REGISTER_SERIALIZABLE(Sheave);

class Bo1_Sheave_Aabb : public BoundFunctor {
public:
    void go(const shared_ptr<Shape>&, shared_ptr<Bound>&, const Se3r&, const Body*) override;
    FUNCTOR1D(Sheave)
    // clang-format off
    YADE_CLASS_BASE_DOC(Bo1_Sheave_Aabb, BoundFunctor, "Box around a :yref:`Sheave` as it is turned now.")
    // clang-format on
};
REGISTER_SERIALIZABLE(Bo1_Sheave_Aabb);

class Ig2_Sheave_Sphere_ScGeom : public IGeomFunctor {
public:
    bool go(const shared_ptr<Shape>&, const shared_ptr<Shape>&, const State&, const State&, const Vector3r& shift2,
            const bool& force, const shared_ptr<Interaction>&) override;
    FUNCTOR2D(Sheave, Sphere)
    DEFINE_FUNCTOR_ORDER_2D(Sheave, Sphere)
    // clang-format off
    YADE_CLASS_BASE_DOC(Ig2_Sheave_Sphere_ScGeom, IGeomFunctor,
        "Contact of a :yref:`Sheave` with a sphere: at the point of the true surface that is nearest.")
    // clang-format on
};
REGISTER_SERIALIZABLE(Ig2_Sheave_Sphere_ScGeom);

class Gl1_Sheave : public GlShapeFunctor {
public:
    void go(const shared_ptr<Shape>&, const shared_ptr<State>&, bool, const GLViewInfo&) override;
    RENDERS(Sheave)
    // clang-format off
    YADE_CLASS_BASE_DOC(Gl1_Sheave, GlShapeFunctor, "Draws a :yref:`Sheave`, with a mark that shows how it turns.")
    // clang-format on
};
REGISTER_SERIALIZABLE(Gl1_Sheave);

} // namespace yade

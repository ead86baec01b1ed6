// SPDX-License-Identifier: GPL-2.0-or-later
// A contact point of a cable: a sphere to all of YADE's functors, moved by the CableEngine.
#pragma once

#include <core/Body.hpp>
#include <core/Dispatching.hpp>
#include <pkg/common/Sphere.hpp>

#include <algorithm>

namespace yade {

class CablePoint : public Sphere {
public:
    // The body's shape as a cable point, or null.
    static const CablePoint* of(const Body& body) {
        const bool is = body.shape && body.shape->getClassIndex() == CablePoint::getClassIndexStatic();
        return is ? static_cast<const CablePoint*>(body.shape.get()) : nullptr;
    }
    bool excludes(Body::id_t other) const {
        return !exclude.empty() && std::find(exclude.begin(), exclude.end(), other) != exclude.end();
    }

    // clang-format off
    YADE_CLASS_BASE_DOC_ATTRS_CTOR(CablePoint, Sphere,
        "Contact point on the centreline of a cable, of the cable's radius. Its body is blocked in all freedoms and has "
        "no mass; :yref:`CableEngine` moves it.",
        ((int, element, -1, , "Element of the engine that it sits on."))
        ((Real, xi, 0, , "Place on the element, 0 to 1."))
        ((int, node, -1, , "Node of the engine that it sits on, -1 inside an element."))
        ((int, family, 0, , "Number of its :yref:`CableEngine`."))
        ((int, edge, -1, , "Number of its edge, unique in the engine."))
        ((Real, arc, 0, , "Unstressed length from the start of its edge [m]."))
        ((bool, selfContact, false, , "Touches other points of its own engine."))
        ((vector<int>, exclude, , , "Bodies that it never touches.")),
        createIndex();
    )
    // clang-format on
    REGISTER_CLASS_INDEX(CablePoint, Sphere)
};
REGISTER_SERIALIZABLE(CablePoint);

class Ig2_CablePoint_CablePoint_ScGeom : public IGeomFunctor {
public:
    bool go(const shared_ptr<Shape>&, const shared_ptr<Shape>&, const State&, const State&, const Vector3r& shift2,
            const bool& force, const shared_ptr<Interaction>&) override;
    FUNCTOR2D(CablePoint, CablePoint)
    DEFINE_FUNCTOR_ORDER_2D(CablePoint, CablePoint)
    // clang-format off
    YADE_CLASS_BASE_DOC(Ig2_CablePoint_CablePoint_ScGeom, IGeomFunctor,
        "Contact of two cables. Neighbours never touch: points of one element or of elements that meet at a node, and "
        "points of one edge less than two diameters apart along it.")
    // clang-format on
};
REGISTER_SERIALIZABLE(Ig2_CablePoint_CablePoint_ScGeom);

} // namespace yade

// SPDX-License-Identifier: GPL-2.0-or-later
#include "CablePoint.hpp"

#include "CableEngine.hpp"

#include <core/Scene.hpp>
#include <pkg/dem/ScGeom.hpp>

#include <cmath>

namespace yade {

YADE_PLUGIN((CablePoint)(Ig2_CablePoint_CablePoint_ScGeom))

namespace {
    bool mayTouch(const Scene& scene, const CablePoint& a, const CablePoint& b) {
        if (a.family != b.family) return true;
        if (!a.selfContact || !b.selfContact) return false;
        if (a.edge == b.edge && std::abs(a.arc - b.arc) < 2 * (a.radius + b.radius)) return false;
        const CableEngine* engine = CableEngine::find(scene, a.family);
        return engine && !engine->adjacent(a.element, b.element);
    }
} // namespace

bool Ig2_CablePoint_CablePoint_ScGeom::go(const shared_ptr<Shape>& shape1, const shared_ptr<Shape>& shape2,
                                          const State& state1, const State& state2, const Vector3r& shift2,
                                          const bool& force, const shared_ptr<Interaction>& contact) {
    const auto &a = static_cast<const CablePoint&>(*shape1), &b = static_cast<const CablePoint&>(*shape2);
    const Vector3r branch = state2.pos + shift2 - state1.pos;
    const Real distance = branch.norm(), depth = a.radius + b.radius - distance;
    if (depth < 0 && !contact->isReal() && !force) return false;
    if (distance == 0 || !mayTouch(*scene, a, b)) return false;
    const bool fresh = !contact->geom;
    if (fresh) contact->geom = shared_ptr<ScGeom>(new ScGeom);
    auto& geom = static_cast<ScGeom&>(*contact->geom);
    const Vector3r normal = branch / distance;
    geom.radius1 = a.radius;
    geom.radius2 = b.radius;
    geom.penetrationDepth = depth;
    geom.contactPoint = state1.pos + (a.radius - depth / 2) * normal;
    geom.precompute(state1, state2, scene, contact, normal, fresh, shift2, false);
    return true;
}

} // namespace yade

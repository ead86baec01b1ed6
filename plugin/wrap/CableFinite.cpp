// SPDX-License-Identifier: GPL-2.0-or-later
// What is no longer a number, told with what it came from, and how fast bodies move.
#include "CableEngine.hpp"

#include "CableCheck.hpp"
#include "CableNodes.hpp"
#include "Mobility.hpp"
#include "text.hpp"

#include <core/Omega.hpp>
#include <pkg/common/Box.hpp>
#include <pkg/common/Sphere.hpp>

extern "C" {
#include "ancf/stability.h"
}

#include <cmath>

namespace yade {

namespace {
    // What a body may move in a step, against its thickness: from outside it stays on its side until the middle of the
    // step, where contacts are looked for.
    constexpr Real waysMost = 2;

    string valueOf(const Vector3r& v) { return text("(", v[0], ", ", v[1], ", ", v[2], ")"); }

    // Half of what a body must move to pass through a line [m].
    Real thicknessOf(const Body& body) {
        if (const auto* sphere = dynamic_cast<const Sphere*>(body.shape.get())) return sphere->radius;
        if (const auto* box = dynamic_cast<const Box*>(body.shape.get())) return box->extents.minCoeff();
        return std::numeric_limits<Real>::infinity();
    }
} // namespace

// Bodies whose motion is looked at: all but elements, which their engine moves.
void CableEngine::listBodies() {
    const CableCheck check(*this);
    const Real thinnest = radius.empty() ? 0 : *std::min_element(radius.begin(), radius.end());
    lookedAt.clear();
    for (const auto& body : *theScene().bodies)
        if (body && !CableElement::of(*body))
            lookedAt.push_back({body->id, check.mayMeet(*body) ? thicknessOf(*body) + thinnest : infinity});
}

// Tells what is not finite; returns the largest speed of a body. Sees whether one could pass through cables in a step.
Real CableEngine::checkFinite() {
    const Scene& s = theScene();
    if (!ancf_finite(model.get(), position.data())) tellNode();
    Real fastest = 0;
    fast = false;
    for (const Looked& one : lookedAt) {
        if (!s.bodies->exists(one.id)) continue;
        const Body& body = *(*s.bodies)[one.id];
        const State& state = *body.state;
        if (!std::isfinite(state.pos.sum() + state.vel.sum() + state.angVel.sum() + state.ori.coeffs().sum()))
            tellBody(body);
        const Real speed = state.vel.norm();
        fastest = std::max(fastest, speed);
        const Real ways = speed * s.dt / one.thickness;
        fast = fast || ways > 1;
        if (ways > waysMost)
            refuse(text("at iteration ", s.iter, " body ", one.id, " moves ", speed * s.dt,
                        " m in a step, and could pass through cables without meeting them: use O.dt <= ",
                        s.dt * waysMost / ways));
    }
    return fastest;
}

void CableEngine::tellBody(const Body& body) const {
    const State& state = *body.state;
    const auto tell = [&](const char* name, const Vector3r& value) {
        if (!value.allFinite())
            refuse(text("at iteration ", theScene().iter, " body ", body.id, " has ", name, " = ", valueOf(value),
                        ": must be finite; look at its mass, its inertia, and the forces on it"));
    };
    Vector3r force, torque;
    forceOn(*Omega::instance().getScene(), body, force, torque);
    tell("a force", force);
    tell("a torque", torque);
    if (carrierOf(body.id) >= 0 && !ancf_finite(model.get(), position.data())) return; // it has that of its knot
    tell("state.pos", state.pos);
    tell("state.vel", state.vel);
    tell("state.angVel", state.angVel);
    tell("state.ori", state.ori.vec());
}

// A node's position is not finite: tells where that came from, if it can be seen.
void CableEngine::tellNode() const {
    const Scene& s = theScene();
    for (const Looked& one : lookedAt)
        if (s.bodies->exists(one.id)) tellBody(*(*s.bodies)[one.id]);
    int first = -1, last = -1;
    for (int node = 0; node < nNodes; ++node)
        if (!nodeOf(position.data(), getStride(), node).allFinite()) {
            last = node;
            if (first < 0) first = node;
        }
    const string what = first < 0       ? string("a slope is")
                        : first == last ? text("the position of node ", first, " is")
                                        : text("positions of nodes ", first, " to ", last, " are");
    refuse(text("at iteration ", s.iter, " ", what, " no longer finite: O.dt = ", s.dt,
                " s was too long, or a force on it or a velocity that was set is not finite"));
}

} // namespace yade

// SPDX-License-Identifier: GPL-2.0-or-later
// How a body answers to a force at one of its points.
#pragma once

#include <core/Body.hpp>
#include <core/Scene.hpp>

namespace yade {

// Velocity of the body's point at a place in space [m/s].
inline Vector3r velocityAt(const State& state, const Vector3r& at) {
    return state.vel + state.angVel.cross(at - state.pos);
}

// Rotation by a vector whose length is the angle [rad].
inline Quaternionr turned(const Vector3r& angle) {
    const Real size = angle.norm();
    return size > 0 ? Quaternionr(AngleAxisr(size, angle / size)) : Quaternionr::Identity();
}

// The body whose inertia answers: the clump for a member.
const Body& movedBody(const Scene& scene, const Body& body);

// Force and torque on a body before NewtonIntegrator, those on a clump's members included.
void forceOn(Scene& scene, const Body& body, Vector3r& force, Vector3r& torque);

struct Mobility {
    Vector3r inverseMass = Vector3r::Zero();    // per axis [1/kg]; 0 where it cannot move
    Matrix3r inverseInertia = Matrix3r::Zero(); // on the axes of the scene [1/(kg m²)]
    Vector3r along = Vector3r::Zero();          // direction of a guide over the root of the mass on it [1/√kg]

    Matrix3r massPart() const { return Matrix3r(inverseMass.asDiagonal()) + along * along.transpose(); }
    bool movable() const {
        return inverseMass != Vector3r::Zero() || inverseInertia != Matrix3r::Zero() || along != Vector3r::Zero();
    }
};

// With what engines such as SheaveEngine do for bodies that NewtonIntegrator sees as blocked.
Mobility mobility(const Scene& scene, const Body& moved);

// direction·(velocity gained at `at` by a unit impulse along direction) [1/kg].
Real compliance(const Mobility& m, const Body& moved, const Vector3r& at, const Vector3r& direction);

// Adds a force and a torque to those on a body so that their sum has the same bits in whatever order, and by whatever
// threads, it is made. Both are rounded to a power of two, by less than 1e-16 of the force that moves the body by its
// radius of gyration in one step (of the torque that turns it by 1). Such numbers add up without error as long as the
// sum is below half of that force: ten times what a contact a tenth of the radius deep gives at its own step. `moved`
// is movedBody(body); one without mass or inertia, or blocked altogether, gets them as they are. Returns what was
// rounded off.
struct Left {
    Vector3r force, torque;
};
Left addExactly(Scene& scene, const Body& body, const Body& moved, const Vector3r& force, const Vector3r& torque);

} // namespace yade

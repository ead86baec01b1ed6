// SPDX-License-Identifier: GPL-2.0-or-later
#include "Mobility.hpp"

#include "Drive.hpp"

#include <core/Clump.hpp>

#include <cmath>

namespace yade {

const Body& movedBody(const Scene& scene, const Body& body) {
    return body.isClumpMember() ? *(*scene.bodies)[body.clumpId] : body;
}

void forceOn(Scene& scene, const Body& body, Vector3r& force, Vector3r& torque) {
    scene.forces.sync();
    force = scene.forces.getForce(body.id);
    torque = scene.forces.getTorque(body.id);
    if (!body.isClump()) return;
    for (const auto& member : static_cast<const Clump&>(*body.shape).members) {
        const Vector3r& f = scene.forces.getForce(member.first);
        force += f;
        torque += scene.forces.getTorque(member.first) +
                  ((*scene.bodies)[member.first]->state->pos - body.state->pos).cross(f);
    }
}

namespace {
    Real inverse(Real inertia) { return inertia > 0 ? 1 / inertia : 0; }
} // namespace

Mobility mobility(const Scene& scene, const Body& moved) {
    const State& state = *moved.state;
    Mobility m;
    for (int i = 0; i < 3; ++i)
        if (!(state.blockedDOFs & (State::DOF_X << i))) m.inverseMass[i] = inverse(state.mass);
    const unsigned turns = ~state.blockedDOFs & State::DOF_RXRYRZ;
    if (turns == State::DOF_RXRYRZ && moved.isAspherical()) {
        const Matrix3r axes = state.ori.toRotationMatrix();
        m.inverseInertia = axes * state.inertia.cwiseInverse().asDiagonal() * axes.transpose();
    } else // turned about the axes of the scene, as NewtonIntegrator does
        for (int i = 0; i < 3; ++i)
            if (turns & (State::DOF_RX << i)) m.inverseInertia(i, i) = inverse(state.inertia[i]);
    if (!turns || !(~state.blockedDOFs & State::DOF_XYZ))
        eachDrive(scene, [&](const Drive& drive) { drive.addMobility(m, scene, moved); });
    return m;
}

Real compliance(const Mobility& m, const Body& moved, const Vector3r& at, const Vector3r& direction) {
    const Vector3r turn = (at - moved.state->pos).cross(direction);
    return direction.dot(m.massPart() * direction) + turn.dot(m.inverseInertia * turn);
}

namespace {
    Vector3r rounded(const Vector3r& value, Real largest) {
        if (!(largest > 0 && std::isfinite(largest))) return value;
        const Real unit = std::ldexp(1., std::ilogb(largest) - 53);
        return Vector3r(std::rint(value[0] / unit), std::rint(value[1] / unit), std::rint(value[2] / unit)) * unit;
    }
} // namespace

Left addExactly(Scene& scene, const Body& body, const Body& moved, const Vector3r& force, const Vector3r& torque) {
    const State& state = *moved.state;
    if (state.blockedDOFs == State::DOF_ALL) { // read, but moving nothing
        scene.forces.addForce(body.id, force);
        scene.forces.addTorque(body.id, torque);
        return {Vector3r::Zero(), Vector3r::Zero()};
    }
    const Real inertia = state.inertia.maxCoeff(), square = scene.dt * scene.dt;
    const Vector3r f = rounded(force, std::sqrt(state.mass * inertia) / square), t = rounded(torque, inertia / square);
    scene.forces.addForce(body.id, f);
    scene.forces.addTorque(body.id, t);
    return {force - f, torque - t};
}

} // namespace yade

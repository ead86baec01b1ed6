// SPDX-License-Identifier: GPL-2.0-or-later
#include "Mobility.hpp"

#include "Drive.hpp"

#include <core/Clump.hpp>
#include <core/Interaction.hpp>

#include <algorithm>

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

Mobility mobility(const Scene& scene, const Body& moved) {
    const State& state = *moved.state;
    Mobility m;
    for (int i = 0; i < 3; ++i)
        if (!(state.blockedDOFs & (State::DOF_X << i))) m.inverseMass[i] = 1 / state.mass;
    const unsigned turns = ~state.blockedDOFs & State::DOF_RXRYRZ;
    if (turns == State::DOF_RXRYRZ && moved.isAspherical()) {
        const Matrix3r axes = state.ori.toRotationMatrix();
        m.inverseInertia = axes * state.inertia.cwiseInverse().asDiagonal() * axes.transpose();
    } else // turned about the axes of the scene, as NewtonIntegrator does
        for (int i = 0; i < 3; ++i)
            if (turns & (State::DOF_RX << i)) m.inverseInertia(i, i) = 1 / state.inertia[i];
    if (!turns || !(~state.blockedDOFs & State::DOF_XYZ))
        eachDrive(scene, [&](const Drive& drive) { drive.addMobility(m, scene, moved); });
    return m;
}

namespace {
    long touching(const Body& body) {
        return std::count_if(body.intrs.begin(), body.intrs.end(), [](const auto& i) { return i.second->isReal(); });
    }
} // namespace

Real sharedCompliance(const Scene& scene, const Body& body, const Vector3r& at, const Vector3r& direction) {
    const Body& moved = movedBody(scene, body);
    const Mobility m = mobility(scene, moved);
    const Vector3r turn = (at - moved.state->pos).cross(direction);
    const Real alone = direction.dot(m.massPart() * direction) + turn.dot(m.inverseInertia * turn);
    return alone > 0 ? alone * static_cast<Real>(std::max(1L, touching(body))) : 0;
}

} // namespace yade

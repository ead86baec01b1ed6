// SPDX-License-Identifier: GPL-2.0-or-later
// What the engine tells: places, forces, energies, momenta; and rest.
#include "CableEngine.hpp"

#include "CableCheck.hpp"
#include "CableNodes.hpp"
#include "CableRest.hpp"
#include "Drive.hpp"

#include <pkg/dem/NewtonIntegrator.hpp>

extern "C" {
#include "ancf/balance.h"
#include "ancf/elastic.h"
#include "ancf/equilibrium.h"
}

#include <cmath>

namespace yade {

// Energies at the half step, where the velocities are.
void CableEngine::trackEnergy(const ancf_time& time) {
    ancf_energy now;
    ancf_energy_of(&now, model.get(), 0, nElements());
    auto& tracker = *scene->energy;
    tracker.add(now.kinetic, "cableKinetic", kineticIx, true);
    const Real elastic = now.axial + now.bending, back = .5 / time.substeps; // velocities are half a sub-step old
    tracker.add(elastic + back * (lastElastic - elastic), "cableElastic", elasticIx, true);
    lastElastic = elastic;
    trackedIter = scene->iter;
    Real lifted = 0;
    if (gravity != Vector3r::Zero()) {
        for (int c = 0; c < 3; ++c) // without carried masses, which NewtonIntegrator counts
            for (int i = 0; i < model->n_dof; ++i) {
                const Real moved = time.step * model->v[c * model->stride + i];
                const bool copy = i >= nNodes + nElements() && next[i - nNodes - nElements()] >= 0;
                if (!copy) lifted -= gravity[c] * model->weight[i] * moved;
            }
        for (size_t i = 0; i < carryNodes.size(); ++i)
            if (carrierOf(carryIds[i]) >= 0)
                lifted += time.step * (*scene->bodies)[carryIds[i]]->state->mass *
                          gravity.dot(nodeOf(model->v, model->stride, carryNodes[i]));
    }
    tracker.add(lifted, "gravWork", gravityIx, false);
    tracker.add(model->damping_work, "cableDamping", dampingIx, false);
    Real pressed, damped, rubbed;
    touching.track(pressed, damped, rubbed);
    tracker.add(pressed, "contactElastic", pressIx, true);
    tracker.add(damped, "contactDamping", contactIx, false);
    tracker.add(rubbed, "cableFriction", frictionIx, false);
}

namespace {
    void checkPlace(int element, Real xi, int n) {
        if (element < 0 || element >= n)
            throw std::out_of_range(text("CableEngine: element ", element, " does not exist, there are ", n));
        if (!(xi >= 0 && xi <= 1))
            throw std::invalid_argument(text("CableEngine: xi = ", xi, " on element ", element, ": must be 0 to 1"));
    }
} // namespace

Vector3r CableEngine::point(int element, Real xi) {
    checkPlace(element, xi, nElements());
    if (!model) build();
    return placeOf(model.get(), position.data(), element, xi);
}

Vector3r CableEngine::pointVelocity(int element, Real xi) {
    checkPlace(element, xi, nElements());
    if (!model) build();
    return placeOf(model.get(), velocity.data(), element, xi);
}

Real CableEngine::tension(int element, Real xi) {
    checkPlace(element, xi, nElements());
    if (!model) build();
    model->x = position.data();
    model->v = velocity.data();
    return ancf_tension(model.get(), element, xi);
}

Real CableEngine::strain(int element, Real xi) {
    checkPlace(element, xi, nElements());
    if (!model) build();
    return ancf_strain(model.get(), position.data(), element, xi);
}

Vector3r CableEngine::reaction(int node) {
    checkNode(node, "reaction");
    node = tied(node);
    if (!model) build();
    for (size_t i = 0; i < carryNodes.size(); ++i)
        if (carryNodes[i] == node) return carryReaction[i];
    if (!has(fixedNodes, node) && !has(followNodes, node))
        throw std::invalid_argument(text("CableEngine.reaction: node ", node, " is free: nothing holds it"));
    Vector3r force;
    ancf_reaction(force.data(), model.get(), node);
    return force;
}

py::dict CableEngine::energy(int first, int last) {
    if (first < 0 || last > nElements() || first > last)
        throw std::out_of_range(
            text("CableEngine.energy: elements ", first, " to ", last, ": there are ", nElements()));
    if (!model) build();
    model->x = position.data();
    model->v = velocity.data();
    for (int c = 0; c < 3; ++c) model->gravity[c] = gravity[c];
    ancf_energy e;
    ancf_energy_of(&e, model.get(), first, last);
    py::dict all;
    all["kinetic"] = e.kinetic;
    all["axial"] = e.axial;
    all["bending"] = e.bending;
    all["gravity"] = e.gravity;
    return all;
}

py::tuple CableEngine::momentum() {
    if (!model) build();
    model->x = position.data();
    model->v = velocity.data();
    Vector3r linear, angular;
    ancf_momentum(linear.data(), angular.data(), model.get());
    return py::make_tuple(linear, angular);
}

bool CableEngine::coupled() {
    if (!model) build();
    return anyCoupled;
}

void CableEngine::relax(Real tolerance, int iterations) {
    if (!(tolerance > 0) || iterations < 1)
        throw std::invalid_argument(text("CableEngine.relax: tolerance = ", tolerance, ", iterations = ", iterations,
                                         ": both must be above 0"));
    Scene& s = theScene();
    build();
    const CableCheck check(*this);
    check.others();
    check.partners(0);
    if (anyCoupled)
        refuse("relax: a body is carried off its centre or guided, and would have to turn: let the scene come to rest "
               "instead");
    if (const NewtonIntegrator* newton = newtonOf(s)) gravity = newton->gravity;
    for (int c = 0; c < 3; ++c) model->gravity[c] = gravity[c];
    std::fill_n(model->external, position.size(), 0);
    for (size_t i = 0; i < loadNodes.size(); ++i) addNode(model->external, model->stride, loadNodes[i], loads[i]);
    model->track = false;
    CableRest rest(*this);
    const vector<Real> before = position;
    const ancf_error error = ancf_equilibrium(model.get(), tolerance, iterations, rest.get());
    if (error) refuse(text("relax: ", ancf_error_text(error)));
    if (const string moved = rest.moved(); !moved.empty()) {
        std::copy(before.begin(), before.end(), position.begin());
        refuse("relax: " + moved);
    }
    for (size_t i = 0; i < carryNodes.size(); ++i) {
        State& state = *(*s.bodies)[carryIds[i]]->state;
        state.pos = nodeOf(model->x, model->stride, carryNodes[i]);
        state.vel = Vector3r::Zero();
    }
    lastStep = lastSubstep = 0;
    changed();
    s.doSort = true;
}

} // namespace yade

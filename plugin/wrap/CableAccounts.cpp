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
#include "ancf/equilibrium.h"
#include "ancf/mass.h"
#include "ancf/tension.h"
}

#include <cmath>

namespace yade {

namespace {
    constexpr Real NONE_YET = -2; // no step before this one is accounted for
    enum Account { ITER, HEIGHT, PRESSED, DAMPED, RUBBED, SLOWED, LIFTED, LOST, WOUND, ACCOUNTS };
} // namespace

// Energies at the positions that a step starts from: there leapfrog keeps their sum, and NewtonIntegrator counts what
// its bodies had when they came there. Of what the step does, the next one counts what comes after.
void CableEngine::noteEnergy() {
    ancf_model* m = model.get();
    if (openAccounts.size() != ACCOUNTS || openAccounts[ITER] != Real(scene->iter - 1)) {
        openAccounts.assign(ACCOUNTS, 0);
        openAccounts[ITER] = NONE_YET;
        openAccounts[HEIGHT] = heightAt;
        openAccounts[WOUND] = winchWork();
    }
    woundAt = winchWork();
    m->damping_work = m->damping_half = 0;
    if (implicit) implicit->lost = 0;
}

// The first step takes from its own contacts what they stored before it.
void CableEngine::notePressed() {
    if (openAccounts[ITER] == NONE_YET) openAccounts[PRESSED] = touching.found();
}

void CableEngine::trackEnergy() {
    auto& tracker = *scene->energy;
    vector<Real>& open = openAccounts;
    Real rest = kineticAt - meanKineticAt, lifted = heightAt - open[HEIGHT] + open[LIFTED];
    for (size_t i = 0; i < carryNodes.size(); ++i) { // what NewtonIntegrator will count of them
        if (carrierOf(carryIds[i]) < 0) continue;
        const State& state = *(*scene->bodies)[carryIds[i]]->state;
        rest -= state.mass / 2 * state.vel.squaredNorm();
        lifted += scene->dt * state.mass * gravity.dot(state.vel);
    }
    tracker.add(meanKineticAt, "cableKinetic", kineticIx, true);
    tracker.add(rest, "cableHalfStep", halfStepIx, true);
    tracker.add(elasticAt, "cableElastic", elasticIx, true);
    tracker.add(lifted, "gravWork", gravityIx, false);
    tracker.add(open[SLOWED] + model->damping_half, "cableDamping", dampingIx, false);
    if (implicit) tracker.add(open[LOST], "cableNumerical", lostIx, false);
    tracker.add(open[PRESSED], "contactElastic", pressIx, true);
    tracker.add(open[DAMPED], "contactDamping", contactIx, false);
    tracker.add(open[RUBBED], "cableFriction", frictionIx, false);
    if (!spools.empty()) tracker.add(open[WOUND] - woundAt, "winchWork", winchIx, false);
    open[WOUND] = woundAt;
    open[ITER] = Real(scene->iter);
    open[HEIGHT] = heightAt;
    open[SLOWED] = model->damping_work - model->damping_half;
    open[LIFTED] = touching.lift();
    open[LOST] = implicit ? implicit->lost : 0;
    const CableContacts::Energies contacts = touching.energies();
    open[PRESSED] = contacts.elastic;
    open[DAMPED] = contacts.damped;
    open[RUBBED] = contacts.rubbed;
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
    needForces();
    return ancf_tension(model.get(), element, xi);
}

py::tuple CableEngine::maxTension(int first, int last, int parts) {
    if (first < 0 || last > nElements() || first >= last || parts < 1)
        throw std::out_of_range(text("CableEngine.maxTension: elements ", first, " to ", last, ", parts = ", parts,
                                     ": there are ", nElements(), " elements; parts must be 1 or more"));
    needForces();
    int element;
    Real xi;
    const Real tension = ancf_tension_max(&element, &xi, model.get(), first, last, parts);
    return py::make_tuple(tension, element, xi);
}

Real CableEngine::strain(int element, Real xi) {
    checkPlace(element, xi, nElements());
    if (!model) build();
    return ancf_strain(model.get(), position.data(), element, xi);
}

void CableEngine::loadNodesAlone() {
    loaded = true;
    std::fill_n(model->external, position.size(), 0);
    for (size_t i = 0; i < loadNodes.size(); ++i) addNode(model->external, model->stride, loadNodes[i], loads[i]);
    model->unloaded = false;
}

// Forces of the last step, and the state as it is.
void CableEngine::needForces() {
    if (!model) build();
    if (!stepped) findForces();
    model->x = position.data();
    model->v = velocity.data();
}

// Before the first step of a model: forces and accelerations as they are without contact.
void CableEngine::findForces() {
    takeGravity();
    loadNodesAlone();
    ancf_acceleration(model.get(), position.data(), velocity.data());
    for (size_t i = 0; i < carryNodes.size() && lastStep == 0; ++i) setCarryReaction(i, Vector3r::Zero());
    stepped = true;
    movedBy = 0;
}

Vector3r CableEngine::reaction(int node) {
    checkNode(node, "reaction");
    node = tied(node);
    needForces();
    for (size_t i = 0; i < carryNodes.size(); ++i)
        if (carryNodes[i] == node) return carryReaction[i];
    if (!has(fixedNodes, node) && !has(followNodes, node) && !has(slideNodes, node))
        throw std::invalid_argument(text("CableEngine.reaction: node ", node, " is free: nothing holds it"));
    Vector3r force;
    ancf_reaction(force.data(), model.get(), node);
    return force;
}

Vector3r CableEngine::placeOfNode(int node) const { return nodeOf(position.data(), getStride(), tied(node)); }

Real CableEngine::mobilityOfNode(int node) {
    node = tied(node);
    if (!model) build();
    vector<Real> force(position.size(), 0), answer(position.size(), 0);
    const auto line = std::find(slideNodes.begin(), slideNodes.end(), node);
    const Vector3r along = line == slideNodes.end() ? Vector3r(Vector3r::UnitX())
                                                    : slideAlong[static_cast<size_t>(line - slideNodes.begin())];
    setNode(force.data(), getStride(), node, along);
    ancf_mass_solve(model.get(), answer.data(), force.data());
    return along.dot(nodeOf(answer.data(), getStride(), node));
}

Vector3r CableEngine::moment(int node) {
    checkNode(node, "moment");
    node = tied(node);
    needForces();
    const ancf_model* m = model.get();
    Vector3r sum = Vector3r::Zero();
    bool held = false;
    for (int k = m->first[node]; k < m->first[node + 1]; ++k) {
        const int e = m->at[k] >> 1, end = m->at[k] & 1, dof = nNodes + end * nElements() + e;
        if (!m->hold[dof]) continue;
        held = true;
        if (end && m->next[e] >= 0) continue; // told with the start of the next element
        Vector3r force;
        ancf_reaction(force.data(), m, dof);
        const Vector3r slope = nodeOf(m->x, m->stride, dof) - movedBy * nodeOf(m->v, m->stride, dof);
        sum += slope.cross(force);
    }
    if (!held)
        throw std::invalid_argument(
            text("CableEngine.moment: node ", node, ": no slope is held there: clamp it, or ask for reaction"));
    return sum;
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
    for (const ancf_spool& s : spools) {
        Vector3r flow;
        ancf_spool_momentum(flow.data(), &s, model.get(), lastStep);
        linear += flow;
        angular += nodeOf(model->x, model->stride, s.node).cross(flow);
    }
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
    refuseWhileRunning("CableEngine.relax");
    Scene& s = theScene();
    followMaterials();
    build();
    const CableCheck check(*this);
    check.others();
    check.partners(0);
    if (anyCoupled)
        refuse("relax: a body is carried off its centre or guided, and would have to turn: let the scene come to rest "
               "instead");
    takeGravity();
    loadNodesAlone();
    model->track = false;
    if (model->fed) std::fill_n(model->fed, 3 * model->n_elements, 0); // winches stand still
    CableRest rest(*this);
    const vector<Real> before = position;
    const ancf_error error = ancf_equilibrium(model.get(), tolerance, iterations, rest.get());
    if (const string why = error ? ancf_error_text(error) : rest.moved(); !why.empty()) {
        std::copy(before.begin(), before.end(), position.begin());
        dropModel();
        refuse("relax: " + why);
    }
    for (size_t i = 0; i < carryNodes.size(); ++i) {
        State& state = *(*s.bodies)[carryIds[i]]->state;
        state.pos = nodeOf(model->x, model->stride, carryNodes[i]);
        state.vel = Vector3r::Zero();
    }
    lastStep = 0;
    for (ancf_spool& spool : spools) {
        spool.rate = spool.ahead = spool.kinetic = 0;
        std::fill_n(spool.flow, 3, 0);
    }
    keepSpools();
    changed();
    s.doSort = true;
}

} // namespace yade

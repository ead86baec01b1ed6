// SPDX-License-Identifier: GPL-2.0-or-later
// The energy watch: what cables have stored, and what was taken out of them, against the work that was done on them.
//
// Leapfrog's change of kinetic energy is the work of all forces by algebra. What can go wrong is what these forces have
// stored: elastic energy of a step that is too long, or of a contact that is found where no work has led it. So the sum
// is taken up now and then, from the state, and against it what is not a function of the state: the work of nodes that
// are led, of forces on carried bodies, and of contacts, added up in steps that have them. What contacts are found to
// store is compared in every step in which they act, before it moves anything.
#include "CableEngine.hpp"

#include "CableNodes.hpp"
#include "text.hpp"

extern "C" {
#include "ancf/balance.h"
#include "ancf/elastic.h"
#include "ancf/tension.h"
}

#include <algorithm>
#include <cmath>

namespace yade {

namespace {
    constexpr Real interval = 100;    // steps between two looks at the energy, at most
    constexpr Real part = .2;         // of the tolerance: what contacts may exchange between two looks
    constexpr Real rounding = 1e-9;   // part of the potential of gravity that may be
    constexpr Real negligible = 1e-6; // strain with whose energy the scale starts

    // What CableEngine.balance holds.
    enum Sum {
        NEXT,      // steps to the next look
        MARK,      // of the state in which it was saved; 0: was not
        BOOKED,    // 1: with O.trackEnergy, so that damping is known
        FRESH,     // 1: what contacts store in this step is where the sum begins
        BASE,      // sum of energies that is balanced [J]
        LOWEST,    // that was at least [J]
        START,     // potential of gravity at BASE [J]
        OUTER,     // work of what leads nodes, of forces on carried bodies, and changes of loads [J]
        GIVEN,     // to bodies by contacts and couplings [J]
        TAKEN,     // from them [J]
        LOST,      // in contacts, by damping and friction [J]
        SLOWED,    // by damping of cables, as far as it is known [J]
        STORED,    // in contacts, at the end of the last step [J]
        FOUND,     // what they were found to store besides, in all [J]
        SEEN,      // of that, at the last look [J]
        EXCHANGED, // by contacts since then [J]
        SUMS
    };

    Real sumOf(const vector<Real>& values, Real before) {
        Real weight = 0;
        for (const Real value : values) before += (weight += 1) * value;
        return before;
    }
} // namespace

// Of all that an edit between O.load and the first step could change.
Real CableEngine::markOfState() const {
    Real mark = 1;
    for (const auto* values : {&position, &velocity, &length, &ea, &ei, &rhoA, &kelvinVoigt, &massDamping})
        mark = sumOf(*values, mark);
    return mark;
}

void CableEngine::keepBalance() {
    if (balance.size() == SUMS && balanced) balance[MARK] = markOfState();
}

// True if the energies are wanted at the positions that this step starts from.
bool CableEngine::balanceDue() {
    if (!(energyTolerance < std::numeric_limits<Real>::infinity())) {
        balance.clear();
        balanced = false;
        return false;
    }
    if (!balanced) {
        const bool loaded = balance.size() == SUMS && balance[MARK] != 0 && balance[MARK] == markOfState();
        if (balance.size() != SUMS) balance.assign(SUMS, 0);
        if (!loaded) balance[NEXT] = 0;
        balanceGoesOn = loaded;
        balanced = true;
    }
    balance[MARK] = 0;
    if (balance[BOOKED] != Real(scene->trackEnergy)) {
        balance[BOOKED] = scene->trackEnergy;
        balanceGoesOn = false;
    }
    if (!balanceGoesOn || scene->trackEnergy) balance[NEXT] = 0;
    if (balance[NEXT] > 0) {
        --balance[NEXT];
        return false;
    }
    return true;
}

// Energies at the positions that a step starts from.
void CableEngine::measureEnergy(const ancf_time& time) {
    ancf_model* m = model.get();
    const bool leapfrog = integrator == "leapfrog";
    const Real last = leapfrog ? time.last : 0, next = leapfrog ? time.step : 0;
    if (implicit || !m->track) { // else leapfrog has it from its forces
        Real axial, bending;
        ancf_elastic_energy(&axial, &bending, m, m->x, 0, nElements());
        m->elastic = axial + bending;
    }
    elasticAt = m->elastic;
    heightAt = ancf_height(m);
    const bool kept = leapfrog && m->track && spools.empty(); // what is fed comes after it
    kineticAt = kept ? m->kinetic : ancf_kinetic_kept(m, last, next);
    if (scene->trackEnergy) meanKineticAt = kept ? m->kinetic_mean : ancf_kinetic_kept(m, last, 0);
    for (const ancf_spool& s : spools) {
        kineticAt += s.kinetic;
        meanKineticAt += s.kinetic;
    }
    for (size_t i = 0; i < carryNodes.size(); ++i) {
        if (carrierOf(carryIds[i]) < 0) continue;
        const Vector3r a = nodeOf(m->a, m->stride, carryNodes[i]);
        const Vector3r mean = nodeOf(m->v, m->stride, carryNodes[i]) + last / 2 * a;
        kineticAt +=
            (*scene->bodies)[carryIds[i]]->state->mass / 2 * (mean.squaredNorm() - (next / 2 * a).squaredNorm());
    }
}

// What damping takes out is known with O.trackEnergy alone; other integrators than leapfrog lose energy besides.
bool CableEngine::lossesKnown() const {
    if (integrator != "leapfrog") return false;
    const auto none = [](const vector<Real>& damping) {
        return std::all_of(damping.begin(), damping.end(), [](Real value) { return value == 0; });
    };
    return scene->trackEnergy || (none(kelvinVoigt) && none(massDamping));
}

// At the positions that the step starts from, and the energies of now.
void CableEngine::lookAtBalance(const ancf_time& time) {
    vector<Real>& b = balance;
    Real potential = heightAt;
    for (size_t i = 0; i < loadNodes.size(); ++i)
        potential -= loads[i].dot(nodeOf(model->x, model->stride, loadNodes[i]));
    const Real slowed = model->track && !implicit && integrator == "leapfrog"
                            ? b[SLOWED] - ancf_kick(&time) / 2 * model->damping_power[0]
                            : b[SLOWED];
    Real now =
        kineticAt + elasticAt + potential + b[STORED] + b[LOST] + b[GIVEN] - b[TAKEN] + slowed - b[OUTER] - winchWork();
    for (const Worked& one : worked) now -= forceOf(one).dot(time.last / 2 * one.before);
    if (!balanceGoesOn) {
        b[BASE] = now;
        b[LOWEST] = b[FOUND] = 0;
        b[START] = potential;
        b[FRESH] = 1;
        Real floor = 0;
        for (int e = 0; e < nElements(); ++e) floor += ea[e] * length[e] / 2 * negligible * negligible;
        energyScale = std::max(energyScale, floor);
    }
    balanceGoesOn = true;
    energyOff = now - b[BASE];
    b[LOWEST] = std::min(b[LOWEST], energyOff);
    energyScale =
        std::max({energyScale, kineticAt + elasticAt + b[STORED], std::abs(b[OUTER]), std::abs(winchWork()), b[GIVEN],
                  b[TAKEN], b[LOST] + slowed, std::abs(potential - b[START]), rounding * std::abs(potential)});
    b[SEEN] = b[FOUND];
    b[EXCHANGED] = 0;
    b[NEXT] = interval - 1;
    judgeBalance(0);
}

// found: what contacts are found to store in this step besides what the one before had left.
void CableEngine::judgeBalance(Real found) {
    const vector<Real>& b = balance;
    const Real off = energyOff + b[FOUND] - b[SEEN] + found, contacts = b[FOUND] + found;
    const Real most = energyTolerance * energyScale;
    // Damping takes out what is not known: then what has been gained since the sum was lowest.
    Real amount = off;
    if (!lossesKnown()) amount -= integrator == "leapfrog" ? std::min(b[LOWEST], off) : std::min(off, 0.);
    if (!std::isfinite(off)) return; // watch() names what is not
    if (std::abs(amount) <= most && std::abs(contacts) <= most) return;
    try {
        check(); // names what was edited, if that is the reason
    } catch (const std::invalid_argument& error) {
        throw std::runtime_error(error.what());
    }
    const bool byContacts = std::abs(contacts) > std::abs(amount) / 2;
    if (std::abs(amount) <= most) amount = contacts;
    int element = 0;
    const Real strain = ancf_strain_max(model.get(), model->x, &element);
    string where = byContacts ? touching.mostFound() : string();
    if (where.empty()) where = text("element ", element, ", which has the largest strain, ", strain);
    const string loseMore =
        implicit && spectralRadius > 0 ? text("a spectralRadius below ", spectralRadius, ", ") : string();
    refuse(text("at iteration ", scene->iter, " the energy is out of balance: ", std::abs(amount), " J were ",
                amount < 0 ? "lost" : "gained", ", ", 100 * std::abs(amount) / energyScale, " % of ", energyScale,
                " J, most likely by ", where, ". The step O.dt = ", scene->dt,
                " s is too long for that: use O.dt = ", scene->dt / 2, " s, ", loseMore,
                "or damping (energyTolerance = ", energyTolerance, " is the share allowed; inf: no watch)"));
}

// ---------------------------------------------------------------- booked in steps

// Velocities of nodes that are fastened to bodies off their centres, before a step.
void CableEngine::noteFastened() {
    fastened.clear();
    if (!anyCoupled || !balanced) return;
    for (size_t i = 0; i < carryIds.size(); ++i)
        if (carrierOf(carryIds[i]) < 0) fastened.push_back({i, nodeOf(model->v, model->stride, carryNodes[i])});
}

// The table's work on a body goes with what moves it before the cable does; the node's way goes with its own mean.
void CableEngine::bookFastened(const ancf_time& time) {
    for (const Fastened& one : fastened) {
        const Body::id_t id = carryIds[one.carried];
        const Vector3r arm = (*scene->bodies)[id]->state->ori * carryAt[one.carried];
        const Vector3r change = touching.velocityBefore(id, arm) - one.before;
        balance[GIVEN] += ancf_kick(&time) / 2 * carryReaction[one.carried].dot(change);
    }
}

// What something does work on, as it is before a step.
void CableEngine::noteWorked() {
    worked.clear();
    if (!balanced) return;
    const ancf_model* m = model.get();
    const auto noteLed = [&](int dof) {
        const Vector3r before = nodeOf(m->v, m->stride, dof);
        if (before != Vector3r::Zero() || nodeOf(m->held, m->stride, dof) != Vector3r::Zero())
            worked.push_back({dof, LED, before, Vector3r::Zero()});
    };
    for (const int node : followNodes) noteLed(node);
    for (const Led& one : led) noteLed(one.dof);
    for (size_t i = 0; i < carryNodes.size(); ++i)
        if (carriedForce[i] != Vector3r::Zero() && carrierOf(carryIds[i]) >= 0)
            worked.push_back(
                {carryNodes[i], static_cast<int>(i), nodeOf(m->v, m->stride, carryNodes[i]), Vector3r::Zero()});
    for (const Pulls& one : pulls)
        for (const auto& [node, force] : one.forces)
            if (const Vector3r now = pullOn(node, force); now != Vector3r::Zero())
                worked.push_back({node, PULLED, nodeOf(m->v, m->stride, node), now});
    if (!worked.empty() && integrator != "leapfrog") balanceGoesOn = false; // their work is not known
}

Vector3r CableEngine::forceOf(const Worked& one) const {
    if (one.by >= 0) return carriedForce[one.by];
    if (one.by == PULLED) return one.pulling;
    Vector3r force;
    ancf_reaction(force.data(), model.get(), one.dof);
    return force;
}

// The work on them, as leapfrog has it: each way goes with the mean of the forces at its ends.
void CableEngine::bookWorked(const ancf_time& time) {
    const ancf_model* m = model.get();
    for (const Worked& one : worked) {
        const Vector3r after = nodeOf(m->v, m->stride, one.dof);
        balance[OUTER] += forceOf(one).dot(time.last * one.before + time.step * after) / 2;
        const Real* shift = touching.displacement();
        if (!shift) continue;
        if (one.by != LED) {
            balance[OUTER] += forceOf(one).dot(nodeOf(shift, m->stride, one.dof));
            continue;
        }
        Vector3r impulse; // of contacts, that what leads it takes
        touching.impulseOn(impulse, m, one.dof);
        balance[OUTER] -= impulse.dot(one.before + after) / 2;
    }
}

// Before contacts move anything.
void CableEngine::checkFound() {
    if (!balanced || !balanceGoesOn) return;
    const Real found = touching.found() - balance[STORED];
    if (balance[FRESH] != 0) {
        balance[FRESH] = 0;
        balance[BASE] += found;
        balance[STORED] += found;
    } else if (found != 0) {
        judgeBalance(found);
    }
}

void CableEngine::bookContacts() {
    if (!balanced) return;
    vector<Real>& b = balance;
    const CableContacts::Energies e = touching.energies();
    b[FOUND] += e.found - b[STORED];
    b[EXCHANGED] +=
        std::abs(e.found - b[STORED]) + std::abs(e.elastic - b[STORED]) + e.damped + e.rubbed + e.given + e.taken;
    b[STORED] = e.elastic;
    if (e.elastic > 0) touching.noteFullest();
    b[LOST] += e.damped + e.rubbed;
    b[GIVEN] += e.given;
    b[TAKEN] += e.taken;
    if (b[EXCHANGED] > part * energyTolerance * energyScale) b[NEXT] = 0;
}

void CableEngine::bookLoad(int node, const Vector3r& change) {
    if (balance.size() == SUMS) balance[OUTER] -= change.dot(nodeOf(position.data(), getStride(), node));
}

void CableEngine::bookDamping() {
    if (balanced && model->track && !implicit) balance[SLOWED] += model->damping_work;
}

} // namespace yade

// SPDX-License-Identifier: GPL-2.0-or-later
// The engine made ready, and one step of it.
#include "CableEngine.hpp"

#include "Attributes.hpp"
#include "CableCheck.hpp"
#include "CableNodes.hpp"
#include "Drive.hpp"
#include "LateError.hpp"

#include <pkg/dem/NewtonIntegrator.hpp>

extern "C" {
#include "ancf/mass.h"
#include "ancf/stability.h"
}

#include <array>

namespace yade {

// ---------------------------------------------------------------- getting ready

namespace {
    bool centred(const Scene& s, const Body& body, const Vector3r& place) {
        return place.norm() == 0 && (body.state->blockedDOFs & State::DOF_XYZ) == State::DOF_XYZ &&
               !placedByDrive(s, body);
    }
} // namespace

namespace {
    int numberOf(const string& name, const std::array<const char*, 3>& names) {
        return static_cast<int>(std::find(names.begin(), names.end(), name) - names.begin());
    }
} // namespace

void CableEngine::makeModel() {
    const size_t n = static_cast<size_t>(nNodes), e = length.size();
    vector<ancf_element> elements;
    for (size_t i = 0; i < e; ++i)
        elements.push_back({kind[i], length[i], ea[i], ei[i], rhoA[i], kelvinVoigt[i], massDamping[i]});
    vector<Real> mass(n, 0);
    for (size_t i = 0; i < carryNodes.size(); ++i) {
        const Body& body = bodyOf(theScene(), carryIds[i], "carry");
        if (centred(theScene(), body, carryAt[i])) mass[carryNodes[i]] += body.state->mass;
    }
    vector<int> hold(n + 2 * e, ANCF_FREE);
    for (const int node : fixedNodes) hold[node] = ANCF_HELD;
    for (const int node : followNodes) hold[node] = ANCF_HELD;
    for (const int node : tiedNodes) hold[node] = ANCF_HELD; // nothing is fastened to them any more
    for (const auto* held : {&clampedEnds, &followEnds})
        for (const int end : *held) hold[n + (end % 2) * e + end / 2] = ANCF_HELD;
    const vector<ancf_slide> lines = slides();
    const ancf_def def = {nNodes,      nElements(), elements.data(), ends.data(),
                          next.data(), mass.data(), hold.data(),     static_cast<int>(lines.size()),
                          lines.data()};
    ancf_model* made = nullptr;
    int where = 0;
    const ancf_error error = ancf_model_create(&made, &def, position.data(), velocity.data(), &where);
    if (error) refuse(text("element ", where, ": ", ancf_error_text(error)));
    model.reset(made);
    listLed();
}

// Slopes that follow bodies, each of those that go on from one element into the next once.
void CableEngine::listLed() {
    led.clear();
    const int e = nElements();
    for (size_t i = 0; i < followEnds.size(); ++i) {
        const int end = followEnds[i], dof = nNodes + (end % 2) * e + end / 2;
        if (std::any_of(led.begin(), led.end(), [&](const Led& one) { return one.twin == dof; })) continue;
        led.push_back({dof, ancf_model_twin(model.get(), dof), i, followedAt(ends[end])});
    }
}

// The body that a node follows, or -1.
Body::id_t CableEngine::followedAt(int node) const {
    const auto found = std::find(followNodes.begin(), followNodes.end(), node);
    return found == followNodes.end() ? -1 : followIds[static_cast<size_t>(found - followNodes.begin())];
}

void CableEngine::makeImplicit() {
    implicit.reset();
    if (integrator != "implicit") return;
    ancf_implicit* made = nullptr;
    if (const ancf_error error = ancf_implicit_create(&made, model.get(), spectralRadius))
        refuse(ancf_error_text(error));
    implicit.reset(made);
}

// Which bodies are carried at their centres.
void CableEngine::mapBodies() {
    const Scene& s = theScene();
    carrierOfBody.assign(s.bodies->size(), -1);
    anyCoupled = false;
    for (size_t i = 0; i < carryNodes.size(); ++i)
        if (centred(s, bodyOf(s, carryIds[i], "carry"), carryAt[i])) carrierOfBody[carryIds[i]] = static_cast<int>(i);
        else anyCoupled = true;
}

// All or nothing: what is refused leaves no model behind.
void CableEngine::build() {
    try {
        makeReady();
    } catch (...) {
        dropModel();
        throw;
    }
}

void CableEngine::makeReady() {
    atHome();
    if (forgotten && nNodes == 0)
        refuse("its cables belong to a scene that O.reset() or O.load() has taken away: make a new one");
    needSound();
    checkScene();
    checkBodies();
    checkHeldBodies();
    dropModel();
    normalKind = numberOf(normal, {"linear", "hertz", "nonlinear"});
    frictionKind = numberOf(friction, {"none", "coulomb", "hollars"});
    makeModel();
    loaded = stepped = false;
    checkIntegrator();
    makeSpools();
    makeImplicit();
    if (anyCoupled && substeps > 1)
        refuse(text("substeps = ", substeps,
                    ": a body is carried off its centre or guided, which needs substeps = 1 or 0"));
    int element;
    const Real stable = stableStep(strainReserve, &element);
    checkCriticalStep(stable, element);
    elementIds.resize(length.size(), -1);
    touching.build(*this);
    carriedForce.assign(carryNodes.size(), Vector3r::Zero());
    carryReaction.resize(carryNodes.size(), Vector3r::Zero());
    startWatch();
}

// ---------------------------------------------------------------- one step

namespace {
    bool anyForces(Scene& scene) { return !scene.forces.synced || scene.forces.getPermForceUsed(); }
} // namespace

void CableEngine::takeGravity() {
    if (const NewtonIntegrator* newton = newtonOf(theScene())) {
        const Vector3r& g = newton->gravity;
        if (!finite(g))
            refuse(text("NewtonIntegrator.gravity = (", g[0], ", ", g[1], ", ", g[2],
                        "): must be finite, and below 1e100 [m/s²]"));
        if (gravity != g) balanceGoesOn = false;
        gravity = g;
    }
    for (int c = 0; c < 3; ++c) model->gravity[c] = gravity[c];
}

// New velocities of nodes and slopes that follow a body, exactly to where NewtonIntegrator will take it.
void CableEngine::holdNodes() {
    for (size_t i = 0; i < followNodes.size(); ++i) {
        const State& state = *(*scene->bodies)[followIds[i]]->state;
        const Vector3r target =
            state.pos + scene->dt * state.vel + turned(scene->dt * state.angVel) * (state.ori * followAt[i]);
        setNode(model->held, model->stride, followNodes[i],
                (target - nodeOf(model->x, model->stride, followNodes[i])) / scene->dt);
    }
    for (const Led& one : led) {
        const State& state = *(*scene->bodies)[one.id]->state;
        const Vector3r target = turned(scene->dt * state.angVel) * (state.ori * followSlopes[one.end]);
        for (const int dof : {one.dof, one.twin})
            if (dof >= 0)
                setNode(model->held, model->stride, dof, (target - nodeOf(model->x, model->stride, dof)) / scene->dt);
    }
    for (size_t i = 0; i < carryNodes.size(); ++i) {
        if (carrierOf(carryIds[i]) >= 0) continue;
        const State& state = *(*scene->bodies)[carryIds[i]]->state;
        setNode(model->x, model->stride, carryNodes[i], state.pos + state.ori * carryAt[i]);
    }
}

// A force that somebody put on an element's body acts along all of it, as its weight does.
void CableEngine::gatherOnElements() {
    for (int e = 0; e < static_cast<int>(elementIds.size()); ++e) {
        if (elementIds[e] < 0) continue;
        const Vector3r force = scene->forces.getForce(elementIds[e]);
        if (scene->forces.getTorque(elementIds[e]) != Vector3r::Zero())
            refuse(text("a torque acts on body ", elementIds[e], " of element ", e,
                        ": a cable has no torsion to take it; put forces on its elements instead"));
        if (force == Vector3r::Zero()) continue;
        Real weight[4];
        int dof[4];
        ancf_mass_weight(weight, &model->element[e]);
        ancf_model_dofs(dof, model.get(), e);
        const Real mass = model->element[e].rho_a * model->element[e].length;
        for (int k = 0; k < 4; ++k) addNode(model->external, model->stride, dof[k], weight[k] / mass * force);
    }
}

void CableEngine::pull(const Engine* by, long iter, vector<std::pair<int, Vector3r>>&& forces) {
    const auto old = [&](const Pulls& one) { return one.by == by || one.iter != iter; };
    pulls.erase(std::remove_if(pulls.begin(), pulls.end(), old), pulls.end());
    pulls.push_back({by, iter, std::move(forces)});
}

// False if there are none.
bool CableEngine::gatherPulls() {
    const auto old = [&](const Pulls& one) { return one.iter != scene->iter; };
    pulls.erase(std::remove_if(pulls.begin(), pulls.end(), old), pulls.end());
    pullKick = 1;
    for (const Pulls& one : pulls)
        for (const auto& [node, force] : one.forces) addNode(model->external, model->stride, node, force);
    return !pulls.empty();
}

// In sub-steps all of a pull on a free node is a kick in the first, where the node is where it was found, as with
// contacts: so angular momentum survives.
void CableEngine::kickPulls(int k, int inside) {
    const int kick = k == 0 ? inside : 0, more = kick - pullKick;
    pullKick = kick;
    if (more == 0) return;
    for (const Pulls& one : pulls)
        for (const auto& [node, force] : one.forces)
            if (!model->hold[node]) addNode(model->external, model->stride, node, more * force);
}

Vector3r CableEngine::pullOn(int node, const Vector3r& force) const {
    return model->hold[node] ? force : Vector3r(pullKick * force);
}

// Loads on nodes, and what acts on carried bodies by others' engines and laws.
void CableEngine::gatherForces() {
    const bool forces = anyForces(*scene);
    if (loaded) std::fill_n(model->external, position.size(), 0);
    loaded = gatherPulls() || !loadNodes.empty() || forces;
    model->unloaded = !loaded;
    for (size_t i = 0; i < loadNodes.size(); ++i) addNode(model->external, model->stride, loadNodes[i], loads[i]);
    if (!forces) {
        std::fill(carriedForce.begin(), carriedForce.end(), Vector3r::Zero());
        return;
    }
    scene->forces.sync();
    gatherOnElements();
    for (size_t i = 0; i < carryNodes.size(); ++i) {
        Vector3r torque;
        forceOn(*scene, bodyOf(*scene, carryIds[i], "carry"), carriedForce[i], torque);
        if (carrierOf(carryIds[i]) >= 0) addNode(model->external, model->stride, carryNodes[i], carriedForce[i]);
    }
}

// Of a body on the knot that carries it at its centre: what acts on it, contacts included, less what it takes itself.
void CableEngine::setCarryReaction(size_t i, const Vector3r& touched) {
    if (carrierOf(carryIds[i]) < 0) return;
    const Real mass = (*theScene().bodies)[carryIds[i]]->state->mass;
    carryReaction[i] = carriedForce[i] + touched + mass * (gravity - nodeOf(model->a, model->stride, carryNodes[i]));
}

// Carried bodies go where NewtonIntegrator will find them at the new positions.
void CableEngine::scatter() {
    for (size_t i = 0; i < carryNodes.size(); ++i) {
        if (carrierOf(carryIds[i]) < 0) continue;
        State& state = *(*scene->bodies)[carryIds[i]]->state;
        state.vel = nodeOf(implicit ? model->free : model->v, model->stride, carryNodes[i]); // the mean of the step
        state.pos = nodeOf(model->x, model->stride, carryNodes[i]) - scene->dt * state.vel;
    }
}

// Steps of the cable inside this one, and what touches in them.
void CableEngine::stepExplicit(int inside) {
    const bool look = balanceDue(), measured = look || scene->trackEnergy;
    const bool alone = !touching.begin(*this, inside) && !measured && integrator == "leapfrog" && spools.empty();
    Real dampedBefore = 0; // the positions that the step starts from
    noteFastened();
    for (int k = 0; k < inside; ++k) {
        const ancf_time time {scene->dt / inside, integrator == "rk4" ? scene->dt : lastStep};
        kickPulls(k, inside);
        if (!alone) ancf_predict(model.get(), &time);
        if (!spools.empty()) feedWinches(time);
        clock.passed(StepClock::ELASTIC);
        noteWorked();
        if (k == 0 && measured) measureEnergy(time);
        if (k == 0 && scene->trackEnergy) noteEnergy();
        if (k == 0 && look) lookAtBalance(time);
        clock.passed(StepClock::ENERGY);
        if (k == 0 && !alone) touching.gather(*this);
        clock.passed(StepClock::GATHER);
        touching.solve(*this, time, k, inside);
        if (k == 0) checkFound();
        if (k == 0 && scene->trackEnergy) notePressed();
        clock.passed(StepClock::CONTACT);
        if (integrator == "rk4") {
            if (touching.displacement())
                refuse("integrator = 'rk4' knows neither contact nor bodies carried off their centres: use 'leapfrog'");
            ancf_rk4(model.get(), time.step);
        } else if (alone) {
            ancf_advance(model.get(), &time);
        } else {
            ancf_correct(model.get(), &time, touching.newVelocity(), touching.displacement());
        }
        clock.passed(StepClock::ELASTIC);
        if (!worked.empty()) bookWorked(time);
        if (!spools.empty()) endWinches();
        if (k == 0) dampedBefore = model->damping_half;
        if (k == inside - 1) {
            touching.give(*this, time);
            bookFastened(time);
        }
        lastStep = movedBy = time.step;
        clock.passed(StepClock::SCATTER);
    }
    model->damping_half = dampedBefore;
    bookContacts();
    bookDamping();
    clock.passed(StepClock::ENERGY);
    scatter();
    touching.look(*this);
    clock.passed(StepClock::SCATTER);
}

// Nothing touches in it.
void CableEngine::stepImplicit() {
    const ancf_time time {scene->dt, lastStep};
    const bool look = balanceDue();
    if (look || scene->trackEnergy) measureEnergy(time);
    if (scene->trackEnergy) noteEnergy();
    noteWorked();
    if (look) lookAtBalance(time);
    clock.passed(StepClock::ENERGY);
    const ancf_error error =
        ancf_implicit_step(implicit.get(), model.get(), acceleration.data(), &time, std::max(1, substeps));
    clock.passed(StepClock::ELASTIC);
    rejectedSteps = static_cast<int>(implicit->rejected);
    newtonIterations = implicit->iterations;
    stepParts = implicit->parts;
    if (error)
        refuse(text("at iteration ", scene->iter, " the implicit step O.dt = ", scene->dt,
                    " s does not converge, not in ", stepParts, " parts either (element ", implicit->element,
                    "): a force is not finite, or something moves too fast; look there, use a shorter O.dt or damping, "
                    "or integrator = 'leapfrog'"));
    lastStep = scene->dt;
    movedBy = scene->dt / 2; // forces are means of the step
    for (size_t i = 0; i < carryNodes.size(); ++i) setCarryReaction(i, Vector3r::Zero());
    scatter();
    clock.passed(StepClock::SCATTER);
}

// Velocities of implicit steps are those of the positions: leapfrog starts from them with half a kick.
void CableEngine::startAfresh() {
    const bool known = acceleration.size() == position.size();
    if (known == (integrator == "implicit")) return;
    acceleration.assign(known ? 0 : position.size(), 0);
    lastStep = 0;
}

// What was appended to cables that move already has its velocities at the time of the positions: they go back by half
// of the kick before, as at a start.
void CableEngine::startAppended() {
    const int n = nElements();
    if (integrator == "leapfrog" && lastStep > 0 && (kickedNodes < nNodes || kickedElements < n)) {
        ancf_acceleration(model.get(), model->x, model->v);
        const auto goBack = [&](int first, int end) {
            for (int c = 0; c < 3; ++c)
                for (int i = c * model->stride + first; i < c * model->stride + end; ++i)
                    model->v[i] -= lastStep / 2 * model->a[i];
        };
        goBack(kickedNodes, nNodes);
        goBack(nNodes + kickedElements, nNodes + n);
        goBack(nNodes + n + kickedElements, nNodes + 2 * n);
    }
    kickedNodes = nNodes;
    kickedElements = n;
}

void CableEngine::action() {
    const StepGuard guard;
    throwLate(*scene);
    clock.start(timingDeltas.get());
    touching.stepBegins();
    eachDrive(*scene, [&](Drive& drive) { drive.prepare(*scene); }); // may call Python, which may change the model
    askWinches();                                                    // and so may this
    getReady();
    startAfresh();
    model->x = position.data();
    model->v = velocity.data();
    model->track = scene->trackEnergy;
    takeGravity();
    watch();
    const int inside = stepsInside();

    holdNodes();
    gatherForces();
    startAppended();
    clock.passed(StepClock::GATHER);
    if (implicit) stepImplicit();
    else stepExplicit(inside);
    stepped = true;
    if (scene->trackEnergy) trackEnergy();
    if (!spools.empty()) finishWinches();
    clock.passed(StepClock::ENERGY);
}

} // namespace yade

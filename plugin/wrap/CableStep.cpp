// SPDX-License-Identifier: GPL-2.0-or-later
// The engine made ready, and one step of it.
#include "CableEngine.hpp"

#include "CableCheck.hpp"
#include "CableNodes.hpp"
#include "Drive.hpp"

#include <pkg/dem/NewtonIntegrator.hpp>

namespace yade {

// ---------------------------------------------------------------- getting ready

namespace {
    bool centred(const Scene& s, const Body& body, const Vector3r& place) {
        return place.norm() == 0 && (body.state->blockedDOFs & State::DOF_XYZ) == State::DOF_XYZ &&
               !placedByDrive(s, body);
    }
} // namespace

void CableEngine::makeModel() {
    const size_t n = static_cast<size_t>(nNodes), e = length.size(), size = 3 * static_cast<size_t>(getStride());
    if (kind.size() != e || ea.size() != e || ei.size() != e || rhoA.size() != e || kelvinVoigt.size() != e)
        refuse(text("kind, length, ea, ei, rhoA and kelvinVoigt must have one length, ", next.size()));
    if (position.size() != size || velocity.size() != size)
        refuse(text("position and velocity must have ", size, " entries, 3 blocks of stride"));
    vector<ancf_element> elements;
    for (size_t i = 0; i < e; ++i) elements.push_back({kind[i], length[i], ea[i], ei[i], rhoA[i], kelvinVoigt[i]});
    vector<Real> mass(n, 0);
    for (size_t i = 0; i < carryNodes.size(); ++i) {
        const Body& body = bodyOf(theScene(), carryIds[i], "carry");
        if (centred(theScene(), body, carryAt[i])) mass[carryNodes[i]] += body.state->mass;
    }
    vector<int> hold(n + 2 * e, ANCF_FREE);
    for (const int node : fixedNodes) hold[node] = ANCF_HELD;
    for (const int node : followNodes) hold[node] = ANCF_HELD;
    for (const int node : tiedNodes) hold[node] = ANCF_HELD; // nothing is fastened to them any more
    for (const int end : clampedEnds) hold[n + (end % 2) * e + end / 2] = ANCF_HELD;
    const ancf_def def = {nNodes, nElements(), elements.data(), ends.data(), next.data(), mass.data(), hold.data()};
    ancf_model* made = nullptr;
    int where = 0;
    const ancf_error error = ancf_model_create(&made, &def, position.data(), velocity.data(), &where);
    if (error) refuse(text("element or node ", where, ": ", ancf_error_text(error)));
    model.reset(made);
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

const Body& CableEngine::elementBody(int element) const {
    const Scene& s = theScene();
    const Body::id_t id = elementIds[element];
    if (!s.bodies->exists(id))
        refuse(text("body ", id, " of element ", element,
                    " was erased, or belongs to a scene before O.reset(): erase the whole cable with its engine, or "
                    "make one that touches nothing (contactPoints=0)"));
    return *(*s.bodies)[id];
}

void CableEngine::build() {
    checkScene();
    checkBodies();
    touching.reset();
    makeModel();
    loaded = false;
    checkIntegrator();
    makeImplicit();
    if (anyCoupled && substeps > 1)
        refuse(text("substeps = ", substeps,
                    ": a body is carried off its centre or guided, which needs substeps = 1 or 0"));
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

// New velocities of nodes that follow a body, exactly to where NewtonIntegrator will take it.
void CableEngine::holdNodes() {
    for (size_t i = 0; i < followNodes.size(); ++i) {
        const State& state = *(*scene->bodies)[followIds[i]]->state;
        const Vector3r target =
            state.pos + scene->dt * state.vel + turned(scene->dt * state.angVel) * (state.ori * followAt[i]);
        setNode(model->held, model->stride, followNodes[i],
                (target - nodeOf(model->x, model->stride, followNodes[i])) / scene->dt);
    }
    for (size_t i = 0; i < carryNodes.size(); ++i) {
        if (carrierOf(carryIds[i]) >= 0) continue;
        const State& state = *(*scene->bodies)[carryIds[i]]->state;
        setNode(model->x, model->stride, carryNodes[i], state.pos + state.ori * carryAt[i]);
    }
}

// Loads on nodes, and what acts on carried bodies by others' engines and laws.
void CableEngine::gatherForces() {
    const bool forces = anyForces(*scene);
    if (loaded) std::fill_n(model->external, position.size(), 0);
    loaded = !loadNodes.empty() || forces;
    model->unloaded = !loaded;
    for (size_t i = 0; i < loadNodes.size(); ++i) addNode(model->external, model->stride, loadNodes[i], loads[i]);
    if (!forces) {
        std::fill(carriedForce.begin(), carriedForce.end(), Vector3r::Zero());
        return;
    }
    scene->forces.sync();
    for (size_t i = 0; i < carryNodes.size(); ++i) {
        Vector3r torque;
        forceOn(*scene, bodyOf(*scene, carryIds[i], "carry"), carriedForce[i], torque);
        if (carrierOf(carryIds[i]) >= 0) addNode(model->external, model->stride, carryNodes[i], carriedForce[i]);
    }
}

// Of a body on the knot that carries it at its centre: what acts on it, contacts included, less what it takes itself.
void CableEngine::setCarryReaction(size_t i, const Vector3r& touched) {
    if (carrierOf(carryIds[i]) < 0) return;
    const Real mass = (*scene->bodies)[carryIds[i]]->state->mass;
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

void CableEngine::getReady() {
    const size_t known = carrierOfBody.size();
    followMaterials();
    try {
        if (pairsChecked) {
            checkBodies();
            if (known != scene->bodies->size()) {
                CableCheck(*this).partners(static_cast<Body::id_t>(known));
                checkIntegrator();
            }
        } else {
            build(); // engines that drive bodies may have come since
            checkPairs();
        }
    } catch (...) {
        scene->doSort = true; // the collider may have seen no elements in this step
        throw;
    }
    pairsChecked = true;
}

// Steps of the cable inside this one, and what touches in them.
void CableEngine::stepExplicit(int inside) {
    const bool alone = !touching.begin(*this, inside) && !scene->trackEnergy && integrator == "leapfrog";
    Real dampedBefore = 0; // the positions that the step starts from
    for (int k = 0; k < inside; ++k) {
        const ancf_time time {scene->dt / inside, integrator == "rk4" ? scene->dt : lastStep};
        if (!alone) ancf_predict(model.get(), &time);
        if (k == 0 && scene->trackEnergy) noteEnergy(time);
        if (k == 0 && !alone) touching.gather(*this);
        touching.solve(*this, time, k, inside);
        if (integrator == "rk4") {
            if (touching.displacement())
                refuse("integrator = 'rk4' knows neither contact nor bodies carried off their centres: use 'leapfrog'");
            ancf_rk4(model.get(), time.step);
        } else if (alone) {
            ancf_advance(model.get(), &time);
        } else {
            ancf_correct(model.get(), &time, touching.newVelocity(), touching.displacement());
        }
        if (k == 0) dampedBefore = model->damping_half;
        if (k == inside - 1) touching.give(*this, time);
        lastStep = time.step;
    }
    model->damping_half = dampedBefore;
    scatter();
    touching.look(*this);
}

// Nothing touches in it.
void CableEngine::stepImplicit() {
    const ancf_time time {scene->dt, lastStep};
    if (scene->trackEnergy) noteEnergy(time);
    const ancf_error error =
        ancf_implicit_step(implicit.get(), model.get(), acceleration.data(), &time, std::max(1, substeps));
    rejectedSteps = static_cast<int>(implicit->rejected);
    newtonIterations = implicit->iterations;
    stepParts = implicit->parts;
    if (error)
        refuse(text("at iteration ", scene->iter, " the implicit step O.dt = ", scene->dt,
                    " s does not converge, not in ", stepParts, " parts either (element ", implicit->element,
                    "): a force is not finite, or something moves too fast; look there, use a shorter O.dt or damping, "
                    "or integrator = 'leapfrog'"));
    lastStep = scene->dt;
    for (size_t i = 0; i < carryNodes.size(); ++i) setCarryReaction(i, Vector3r::Zero());
    scatter();
}

// Velocities of implicit steps are those of the positions: leapfrog starts from them with half a kick.
void CableEngine::startAfresh() {
    const bool known = acceleration.size() == position.size();
    if (known == (integrator == "implicit")) return;
    acceleration.assign(known ? 0 : position.size(), 0);
    lastStep = 0;
}

void CableEngine::action() {
    getReady();
    startAfresh();
    model->x = position.data();
    model->v = velocity.data();
    model->track = scene->trackEnergy;
    if (const NewtonIntegrator* newton = newtonOf(*scene)) gravity = newton->gravity;
    watch();
    const int inside = stepsInside();
    for (int c = 0; c < 3; ++c) model->gravity[c] = gravity[c];

    eachDrive(*scene, [&](Drive& drive) { drive.prepare(*scene); });
    holdNodes();
    gatherForces();
    if (implicit) stepImplicit();
    else stepExplicit(inside);
    if (scene->trackEnergy) trackEnergy();
}

} // namespace yade

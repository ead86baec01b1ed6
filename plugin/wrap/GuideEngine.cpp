// SPDX-License-Identifier: GPL-2.0-or-later
#include "GuideEngine.hpp"

#include "Attributes.hpp"

#include <core/Omega.hpp>
#include <pkg/dem/NewtonIntegrator.hpp>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace yade {

YADE_PLUGIN((GuideEngine))

namespace {
    enum { sliding = 0, byFriction = 1, atUpper = 2, atLower = -2 };

    Vector3r forceOnBody(Scene& scene, Body::id_t id) {
        if (!scene.forces.synced) scene.forces.sync();
        return scene.forces.getForce(id);
    }
} // namespace

void GuideEngine::refuse(size_t i, const string& why) const {
    std::ostringstream text;
    text << "GuideEngine: body " << ids[i] << ": " << why;
    throw std::runtime_error(text.str());
}

void GuideEngine::checkLists() const {
    const Attributes all("GuideEngine");
    const size_t n = ids.size();
    const string why = text("one for each of ", n, " ids");
    all.each("ids", ids, "a body", [](int id) { return id >= 0; });
    all.distinct("ids", ids, "a body is on one guide");
    for (const auto& [name, list] :
         {std::pair("friction", &friction), std::pair("viscous", &viscous), std::pair("push", &push),
          std::pair("rubbing", &rubbing), std::pair("lastSpeed", &lastSpeed), std::pair("driveForce", &driveForce),
          std::pair("work", &work), std::pair("loss", &loss)}) {
        all.size(name, *list, n, why);
        all.finiteEach(name, *list);
    }
    all.size("origin", origin, n, why);
    all.size("direction", direction, n, why);
    all.size("lower", lower, n, why);
    all.size("upper", upper, n, why);
    all.size("driven", driven, n, why);
    all.size("held", held, n, why);
    all.notNegative("friction", friction);
    all.notNegative("viscous", viscous);
    all.finiteEach("origin", origin);
    all.each("direction", direction, "a unit vector", [](const Vector3r& d) { return std::abs(d.norm() - 1) < 1e-9; });
    all.each("lower", lower, "at most 0, where the body was added [m]", [](Real value) { return value <= 0; });
    all.each("upper", upper, "at least 0, where the body was added [m]", [](Real value) { return value >= 0; });
    all.within("driven", driven, 0, 2, "no or yes");
    all.each("held", held, "0 (slides), 1 (by friction), 2 (at the upper stop) or -2 (at the lower one)",
             [](int value) { return value == sliding || value == byFriction || std::abs(value) == atUpper; });
}

void GuideEngine::postLoad(GuideEngine&) { takeLists(); }

int GuideEngine::number(Body::id_t id) const {
    needSound();
    const auto found = std::find(ids.begin(), ids.end(), id);
    if (found == ids.end())
        throw std::invalid_argument("GuideEngine: body " + std::to_string(id) +
                                    " is on none of its guides: add() it first");
    return static_cast<int>(found - ids.begin());
}

Real GuideEngine::place(size_t i) const {
    const Scene& s = scene ? *scene : *Omega::instance().getScene();
    return direction[i].dot((*s.bodies)[ids[i]]->state->pos - origin[i]);
}

Real GuideEngine::position(Body::id_t id) const {
    const int i = number(id);
    const Scene& s = scene ? *scene : *Omega::instance().getScene();
    if (!s.bodies->exists(id))
        throw std::invalid_argument("GuideEngine.position: body " + std::to_string(id) + " was erased");
    return place(static_cast<size_t>(i));
}

int GuideEngine::add(Body::id_t id, const Vector3r& newDirection, Real newFriction, Real newViscous, Real newLower,
                     Real newUpper, const py::object& motion) {
    refuseWhileRunning("GuideEngine.add");
    const Scene& s = scene ? *scene : *Omega::instance().getScene();
    const string name = "GuideEngine.add: body " + std::to_string(id);
    const auto need = [&](bool good, const char* rule) {
        if (!good) throw std::invalid_argument(name + rule);
    };
    needSound();
    checkDriven(s, id, name);
    need(std::find(ids.begin(), ids.end(), id) == ids.end(), " is on a guide already");
    const Attributes all(name);
    all.need(finite(newDirection) && newDirection.stableNorm() > 0, "direction", newDirection,
             "finite, below 1e100, and not zero");
    all.need(finite(newFriction) && newFriction >= 0, "friction", newFriction, "finite and not below 0");
    all.need(finite(newViscous) && newViscous >= 0, "viscous", newViscous, "finite and not below 0 [N s/m]");
    need(newLower <= 0 && newUpper >= 0,
         text(": lower = ", newLower, " and upper = ", newUpper, ": it starts beyond its stops: lower <= 0 <= upper")
             .c_str());
    State& state = *(*s.bodies)[id]->state;
    need(!motion.is_none() || state.mass > 0, " has no mass: set state.mass, or give it a motion");
    const Vector3r along = newDirection.stableNormalized();
    ids.push_back(id);
    resize();
    origin.back() = state.pos;
    direction.back() = along;
    friction.back() = newFriction;
    viscous.back() = newViscous;
    lower.back() = newLower;
    upper.back() = newUpper;
    lastSpeed.back() = state.vel.dot(along);
    held.back() = newFriction > 0 && lastSpeed.back() == 0 ? byFriction : sliding;
    try {
        setMotion(id, motion);
    } catch (...) {
        ids.pop_back();
        resize();
        throw;
    }
    // Its rotation is blocked at the first step only: CableEngine.carry refuses what is fixed altogether.
    state.blockedDOFs = motion.is_none() ? State::DOF_XYZ : State::DOF_ALL;
    state.vel = lastSpeed.back() * along;
    return static_cast<int>(ids.size()) - 1;
}

void GuideEngine::resize() {
    const size_t n = ids.size();
    for (auto* values : {&friction, &viscous, &lower, &upper, &push, &rubbing, &lastSpeed, &driveForce, &work, &loss})
        values->resize(n, 0);
    origin.resize(n);
    direction.resize(n);
    driven.resize(n, 0);
    held.resize(n, 0);
}

void GuideEngine::setMotion(Body::id_t id, const py::object& motion) {
    const int i = number(id);
    if (!motion.is_none() && !isFunction(motion))
        throw std::invalid_argument("GuideEngine: motion of body " + std::to_string(id) +
                                    " must be a function of time, or None");
    motions.set(i, motion);
    driven[i] = !motion.is_none();
    if (driven[i]) held[i] = sliding;
    preparedIter = -1;
}

void GuideEngine::check() {
    needSound();
    for (size_t i = 0; i < ids.size(); ++i) {
        if (!scene->bodies->exists(ids[i])) refuse(i, "was erased");
        const State& state = *(*scene->bodies)[ids[i]]->state;
        if ((state.blockedDOFs & State::DOF_XYZ) != State::DOF_XYZ)
            refuse(i, "must be blocked in 'xyz', or NewtonIntegrator moves it a second time");
        if (driven[i] && !motions.has(static_cast<int>(i)))
            refuse(i, "its motion, a Python function of time, is not saved with a scene: setMotion() again");
        (*scene->bodies)[ids[i]]->state->blockedDOFs |= State::DOF_RXRYRZ;
        const ancf_rotor r {driven[i] ? 1 : state.mass, viscous[i], friction[i]};
        if (const ancf_error error = ancf_rotor_check(&r))
            refuse(i, text("state.mass = ", r.inertia, ": ", ancf_error_text(error)));
        const Vector3r way = state.pos - origin[i];
        const Real off = (way - direction[i].dot(way) * direction[i]).norm();
        if (!(off <= 1e-6 * (1 + state.pos.norm())))
            refuse(i, text("state.pos = (", state.pos[0], ", ", state.pos[1], ", ", state.pos[2], ") is ", off,
                           " m off its guide: only the guide may move it"));
        if (!finite(state.vel))
            refuse(i, text("state.vel = (", state.vel[0], ", ", state.vel[1], ", ", state.vel[2],
                           "): must be finite, and below 1e100 [m/s]"));
    }
    numberBodies(*scene);
}

void GuideEngine::prepare(Scene& s) {
    if (prepared(s)) return;
    scene = &s;
    check();
    vector<Real> distances;
    if (callAll(distances, "GuideEngine", ids, s.time + s.dt, [&](size_t i) { return driven[i] ? &motions : nullptr; }))
        check();
    preparedIter = s.iter;
    if (const NewtonIntegrator* newton = newtonOf(s)) gravity = newton->gravity;
    for (size_t i = 0; i < ids.size(); ++i) {
        if (!driven[i]) continue;
        const Vector3r vel = (distances[i] - place(i)) / s.dt * direction[i];
        if (!finite(vel))
            refuse(i, text("motion = ", distances[i], " m at t = ", s.time + s.dt, " s is ", distances[i] - place(i),
                           " m away, in one step of ", s.dt, " s: must be a motion that it can follow"));
        (*s.bodies)[ids[i]]->state->vel = vel;
    }
}

void GuideEngine::addMobility(Mobility& m, const Scene& s, const Body& body) const {
    const int i = numberOf(body);
    if (i < 0 || driven[i] || held[i]) return;
    const ancf_rotor r {body.state->mass, viscous[i], 0};
    m.along = direction[i] / std::sqrt(ancf_rotor_resistance(&r, s.dt));
}

void GuideEngine::predict(Vector3r& velocity, Vector3r&, const Scene& s, const Body& body, const Vector3r& force,
                          const Vector3r&) const {
    const int i = numberOf(body);
    if (i < 0 || driven[i]) return;
    const State& state = *body.state;
    const ancf_rotor r {state.mass, viscous[i], rubbing[i]};
    Real rubbed;
    velocity = held[i] ? Vector3r(Vector3r::Zero())
                       : Vector3r(ancf_rotor_step(&rubbed, &r, state.vel.dot(direction[i]),
                                                  direction[i].dot(force + state.mass * gravity) + push[i], s.dt) *
                                  direction[i]);
}

void GuideEngine::slide(size_t i) {
    State& state = *(*scene->bodies)[ids[i]]->state;
    const Vector3r total = forceOnBody(*scene, ids[i]) + state.mass * gravity;
    const Real along = direction[i].dot(total), dt = scene->dt;
    const Vector3r across = total - along * direction[i];
    Real speed = state.vel.dot(direction[i]), rubbed = 0, stopped = 0;
    if (!driven[i]) lastSpeed[i] = speed;
    rubbing[i] = friction[i] * across.norm();
    if (driven[i]) {
        if (speed != 0) rubbed = speed > 0 ? -rubbing[i] : rubbing[i];
        driveForce[i] = state.mass * (speed - lastSpeed[i]) / dt - along + viscous[i] * speed - rubbed;
    } else {
        const ancf_rotor r {state.mass, viscous[i], rubbing[i]};
        driveForce[i] = push[i];
        speed = ancf_rotor_step(&rubbed, &r, lastSpeed[i], along + push[i], dt);
        const Real at = place(i), wanted = speed;
        speed = std::min(std::max(speed, (lower[i] - at) / dt), (upper[i] - at) / dt);
        stopped = state.mass * (speed - wanted) / dt;
        held[i] = speed < wanted                 ? atUpper
                  : speed > wanted               ? atLower
                  : speed == 0 && rubbing[i] > 0 ? byFriction
                                                 : sliding;
    }
    const Real way = (speed + lastSpeed[i]) / 2 * dt, work1 = driveForce[i] * way,
               loss1 = (viscous[i] * speed - rubbed - stopped) * way;
    state.vel = speed * direction[i];
    lastSpeed[i] = speed;
    work[i] += work1;
    loss[i] += loss1;
    if (!scene->trackEnergy) return;
    scene->energy->add(-work1, "driveWork", workIx, false);
    scene->energy->add(loss1, "guideFriction", lossIx, false);
}

void GuideEngine::action() {
    const StepGuard guard;
    prepare(*scene);
    for (size_t i = 0; i < ids.size(); ++i) slide(i);
    preparedIter = -1; // O.resetTime() may let its number come again
}

} // namespace yade

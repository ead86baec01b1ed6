// SPDX-License-Identifier: GPL-2.0-or-later
#include "SheaveEngine.hpp"

#include "Attributes.hpp"
#include "Sheave.hpp"

#include <core/Omega.hpp>

#include <cmath>
#include <sstream>

namespace yade {

YADE_PLUGIN((SheaveEngine))

namespace {
    constexpr Real unset = std::numeric_limits<Real>::quiet_NaN();
    enum { numbers, speedScript, torqueScript };

    void forceOnBody(Scene& scene, Body::id_t id, Vector3r& force, Vector3r& torque) {
        if (!scene.forces.synced) scene.forces.sync();
        force = scene.forces.getForce(id);
        torque = scene.forces.getTorque(id);
    }
} // namespace

void SheaveEngine::refuse(size_t i, const string& why) const {
    std::ostringstream text;
    text << "SheaveEngine: body " << ids[i] << ": " << why;
    throw std::runtime_error(text.str());
}

Vector3r SheaveEngine::axis(const State& state) const { return Sheave::axisOf(state.ori); }

void SheaveEngine::checkLists() const {
    const Attributes all("SheaveEngine");
    const size_t n = ids.size();
    const string why = text("one for each of ", n, " ids");
    all.each("ids", ids, "a body", [](int id) { return id >= 0; });
    all.distinct("ids", ids, "a body turns once");
    for (const auto& [name, list] :
         {std::pair("viscous", &viscous), std::pair("dry", &dry), std::pair("torque", &torque),
          std::pair("contactTorque", &contactTorque), std::pair("driveTorque", &driveTorque),
          std::pair("angle", &angle), std::pair("work", &work), std::pair("loss", &loss)}) {
        all.size(name, *list, n, why);
        all.finiteEach(name, *list);
    }
    all.size("speed", speed, n, why);
    all.size("scripted", scripted, n, why);
    all.size("stuck", stuck, n, why);
    all.size("load", load, n, why);
    all.notNegative("viscous", viscous);
    all.notNegative("dry", dry);
    all.each("speed", speed, "finite [rad/s], or NaN for free",
             [](Real value) { return std::isnan(value) || finite(value); });
    all.within("scripted", scripted, numbers, torqueScript + 1, "what is a function of time");
    all.within("stuck", stuck, 0, 2, "no or yes");
    all.finiteEach("load", load);
}

void SheaveEngine::postLoad(SheaveEngine&) { takeLists(); }

int SheaveEngine::number(Body::id_t id) const {
    needSound();
    for (size_t i = 0; i < ids.size(); ++i)
        if (ids[i] == id) return static_cast<int>(i);
    throw std::invalid_argument("SheaveEngine: body " + std::to_string(id) + " is not turned by it: add() it first");
}

int SheaveEngine::add(Body::id_t id, Real newViscous, Real newDry, const py::object& newTorque,
                      const py::object& newSpeed) {
    refuseWhileRunning("SheaveEngine.add");
    const Scene& s = scene ? *scene : *Omega::instance().getScene();
    const string name = "SheaveEngine.add: body " + std::to_string(id);
    needSound();
    checkDriven(s, id, name);
    if (std::find(ids.begin(), ids.end(), id) != ids.end()) throw std::invalid_argument(name + " is turned already");
    State& state = *(*s.bodies)[id]->state;
    const ancf_rotor r {1, newViscous, newDry};
    if (const ancf_error error = ancf_rotor_check(&r))
        throw std::invalid_argument(name + ": " + ancf_error_text(error));
    if (newSpeed.is_none() && !(std::isfinite(state.inertia[2]) && state.inertia[2] > 0))
        throw std::invalid_argument(name + " has no moment of inertia: set state.inertia, or give it a speed");
    ids.push_back(id);
    resize();
    viscous.back() = newViscous;
    dry.back() = newDry;
    try {
        setTorque(id, newTorque);
        setSpeed(id, newSpeed);
    } catch (...) {
        ids.pop_back();
        resize();
        throw;
    }
    stuck.back() = newDry > 0 && state.angVel == Vector3r::Zero();
    state.blockedDOFs |= State::DOF_RXRYRZ;
    (*s.bodies)[id]->setAspherical(false);
    preparedIter = -1;
    return static_cast<int>(ids.size()) - 1;
}

void SheaveEngine::resize() {
    const size_t n = ids.size();
    for (auto* values : {&viscous, &dry, &torque, &contactTorque, &driveTorque, &angle, &work, &loss})
        values->resize(n, 0);
    speed.resize(n, unset);
    scripted.resize(n, numbers);
    stuck.resize(n, 0);
    load.resize(n, Vector3r::Zero());
}

void SheaveEngine::setSpeed(Body::id_t id, const py::object& value) {
    const int i = number(id);
    Real fixed = unset;
    if (!value.is_none() && !isFunction(value)) {
        fixed = numberGiven(value, "SheaveEngine: speed", id, "a number, a function of time, or None");
        if (!finite(fixed))
            throw std::invalid_argument(
                text("SheaveEngine: speed = ", fixed, " of body ", id, ": must be finite, and below 1e100 [rad/s]"));
    }
    speeds.set(i, isFunction(value) ? value : py::object());
    if (isFunction(value)) torques.set(i, py::object());
    speed[i] = fixed;
    if (isFunction(value)) scripted[i] = speedScript;
    else if (scripted[i] == speedScript) scripted[i] = numbers;
    stuck[i] = 0;
    preparedIter = -1;
}

void SheaveEngine::setTorque(Body::id_t id, const py::object& value) {
    const int i = number(id);
    if (!isFunction(value)) {
        const Real given = numberGiven(value, "SheaveEngine: torque", id, "a number or a function of time");
        if (!finite(given))
            throw std::invalid_argument(
                text("SheaveEngine: torque = ", given, " of body ", id, ": must be finite, and below 1e100 [N m]"));
        torque[i] = given;
    }
    torques.set(i, isFunction(value) ? value : py::object());
    if (isFunction(value)) scripted[i] = torqueScript;
    else if (scripted[i] == torqueScript) scripted[i] = numbers;
    preparedIter = -1;
}

void SheaveEngine::check() {
    needSound();
    for (size_t i = 0; i < ids.size(); ++i) {
        if (!scene->bodies->exists(ids[i])) refuse(i, "was erased");
        const Body& body = *(*scene->bodies)[ids[i]];
        const State& state = *body.state;
        // On a guide it is, from the first step on.
        if ((state.blockedDOFs & State::DOF_RXRYRZ) != State::DOF_RXRYRZ && !placedByDrive(*scene, body))
            refuse(i, "must be blocked in 'XYZ', or NewtonIntegrator turns it a second time");
        ancf_rotor r = rotor(state, i);
        if (prescribed(i)) r.inertia = 1;
        if (const ancf_error error = ancf_rotor_check(&r))
            refuse(i, text("state.inertia[2] = ", r.inertia, ": ", ancf_error_text(error)));
        if (!finite(state.angVel))
            refuse(i, text("state.angVel = (", state.angVel[0], ", ", state.angVel[1], ", ", state.angVel[2],
                           "): must be finite, and below 1e100 [rad/s]"));
        if (!(std::abs(state.ori.norm() - 1) < 1e-6))
            refuse(i, text("state.ori has the norm ", state.ori.norm(), ": must be that of a rotation, 1"));
        if (scripted[i] && !(scripted[i] == speedScript ? speeds : torques).has(static_cast<int>(i)))
            refuse(i, "its Python function of time is not saved with a scene: set it again");
    }
    numberBodies(*scene);
}

void SheaveEngine::prepare(Scene& s) {
    if (prepared(s)) return;
    scene = &s;
    check();
    vector<Real> values;
    if (callAll(values, "SheaveEngine", ids, s.time + s.dt / 2, [&](size_t i) -> const Schedules* {
            return scripted[i] == speedScript ? &speeds : scripted[i] == torqueScript ? &torques : nullptr;
        }))
        check();
    preparedIter = s.iter;
    for (size_t i = 0; i < ids.size(); ++i) {
        if (scripted[i] == torqueScript) torque[i] = values[i];
        if (!prescribed(i)) continue;
        State& state = *(*s.bodies)[ids[i]]->state;
        state.angMom[2] = state.angVel.dot(axis(state)); // the speed before, for turn()
        state.angVel = (scripted[i] == speedScript ? values[i] : speed[i]) * axis(state);
    }
}

void SheaveEngine::addMobility(Mobility& m, const Scene& s, const Body& body) const {
    const int i = numberOf(body);
    if (i < 0 || prescribed(i) || stuck[i]) return;
    const Vector3r a = axis(*body.state);
    const ancf_rotor r = rotor(*body.state, i);
    m.inverseInertia += a * a.transpose() / ancf_rotor_resistance(&r, s.dt);
}

void SheaveEngine::predict(Vector3r&, Vector3r& spin, const Scene& s, const Body& body, const Vector3r&,
                           const Vector3r& moment) const {
    const int i = numberOf(body);
    if (i < 0 || prescribed(i)) return;
    const Vector3r a = axis(*body.state);
    const ancf_rotor r = rotor(*body.state, i);
    Real friction;
    spin =
        stuck[i]
            ? Vector3r(Vector3r::Zero())
            : Vector3r(ancf_rotor_step(&friction, &r, body.state->angVel.dot(a), moment.dot(a) + torque[i], s.dt) * a);
}

void SheaveEngine::turn(size_t i) {
    State& state = *(*scene->bodies)[ids[i]]->state;
    const Vector3r a = axis(state);
    const ancf_rotor r = rotor(state, i);
    Vector3r moment;
    forceOnBody(*scene, ids[i], load[i], moment);
    contactTorque[i] = moment.dot(a);
    Real before = state.angVel.dot(a), now, friction = 0;
    if (prescribed(i)) {
        now = before;
        before = state.angMom[2];
        if (now != 0) friction = now > 0 ? -dry[i] : dry[i];
        driveTorque[i] = state.inertia[2] * (now - before) / scene->dt - contactTorque[i] + viscous[i] * now - friction;
    } else {
        now = ancf_rotor_step(&friction, &r, before, contactTorque[i] + torque[i], scene->dt);
        stuck[i] = now == 0 && dry[i] > 0;
        driveTorque[i] = torque[i];
        state.angVel = now * a;
    }
    const Real mean = (before + now) / 2 * scene->dt, work1 = driveTorque[i] * mean,
               loss1 = (viscous[i] * now - friction) * mean;
    angle[i] += now * scene->dt;
    work[i] += work1;
    loss[i] += loss1;
    if (!scene->trackEnergy) return;
    scene->energy->add(-work1, "driveWork", workIx, false);
    scene->energy->add(loss1, "bearingFriction", lossIx, false);
}

void SheaveEngine::action() {
    const StepGuard guard;
    prepare(*scene);
    for (size_t i = 0; i < ids.size(); ++i) turn(i);
    preparedIter = -1; // O.resetTime() may let its number come again
}

} // namespace yade

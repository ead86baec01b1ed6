// SPDX-License-Identifier: GPL-2.0-or-later
// Engines that move bodies with one freedom, such as sheaves and slides, which NewtonIntegrator sees as blocked.
#pragma once

#include "Mobility.hpp"

#include <core/Engine.hpp>
#include <lib/pyutil/gil.hpp>
#include <lib/serialization/Serializable.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>

namespace yade {

class Collider;
class InteractionLoop;
class NewtonIntegrator;

class Drive {
    mutable bool sound = true; // false: lists came from outside that checkLists() has not let pass
    vector<int> numberOfBody;  // (bodies) or -1; found anew where `preparedIter` is -1

protected:
    long preparedIter = -1;

    virtual void checkLists() const = 0;
    void needSound() const; // nothing if they passed
    void takeLists();       // that came from outside
    void numberBodies(const Scene& scene);
    bool prepared(const Scene& scene) const; // in this step
    int numberOf(const Body& body) const;    // in bodies(), or -1

public:
    virtual ~Drive() = default;

    // Sets the velocities that are prescribed for the step ahead; nothing if that was done in this step.
    virtual void prepare(Scene& scene) = 0;

    virtual const vector<Body::id_t>& bodies() const = 0; // that it moves
    virtual bool turns(Body::id_t id) const = 0;          // its rotation is ours
    virtual bool places(Body::id_t id) const = 0;         // its translation is ours

    // Adds how a body of ours answers; nothing for others.
    virtual void addMobility(Mobility& m, const Scene& scene, const Body& body) const = 0;

    // Sets the velocity or spin that a body of ours will have after this step under a force and torque, its drive and
    // friction included.
    virtual void predict(Vector3r& velocity, Vector3r& spin, const Scene& scene, const Body& body,
                         const Vector3r& force, const Vector3r& torque) const = 0;
};

// A drive and the engine that it is.
struct DriveEngine {
    const Engine* engine;
    Drive* drive;
};

// Engines of a scene by what they do. Remembered for as long as its list stays the same: asked many times a step.
struct KnownEngines {
    vector<DriveEngine> drives;
    vector<const NewtonIntegrator*> newtons; // the last one first
    vector<const InteractionLoop*> loops;
    vector<const Collider*> colliders;
};
const KnownEngines& knownEngines(const Scene& scene);

inline const vector<DriveEngine>& drivesOf(const Scene& scene) { return knownEngines(scene).drives; }

// Its last NewtonIntegrator that is not switched off, or null.
const NewtonIntegrator* newtonOf(const Scene& scene);

template <class F> void eachDrive(const Scene& scene, F f) {
    for (const DriveEngine& each : drivesOf(scene))
        if (!each.engine->dead) f(*each.drive);
}

inline bool placedByDrive(const Scene& scene, const Body& body) {
    bool found = false;
    eachDrive(scene, [&](const Drive& drive) { found = found || drive.places(body.id); });
    return found;
}

inline bool drivenBody(const Scene& scene, const Body& body) {
    bool found = false;
    eachDrive(scene, [&](const Drive& drive) { found = found || drive.places(body.id) || drive.turns(body.id); });
    return found;
}

// Refuses bodies that no drive can move: invalid_argument, beginning with `name`.
void checkDriven(const Scene& scene, Body::id_t id, const string& name);

// Python functions of time, by number of what they drive. Not saved with a scene.
class Schedules {
    std::map<int, py::object> functions;

public:
    Schedules() = default;
    Schedules(const Schedules&) = delete;
    Schedules& operator=(const Schedules&) = delete;
    ~Schedules();
    void set(int number, const py::object& function); // None: takes it away
    bool has(int number) const { return functions.count(number) > 0; }
    // Its value; std::runtime_error with `name` if it raises, or returns no finite number.
    Real operator()(int number, Real time, const string& name) const;
};

// Values at a time of the functions that drive the bodies `ids`, of(i) or null for each: called before a step has
// changed anything, as they may change the scene. NaN where there is none. False: there are none at all.
template <class Of> bool callAll(vector<Real>& values, const char* engine, const vector<int>& ids, Real time, Of of) {
    const size_t n = ids.size();
    values.assign(n, std::numeric_limits<Real>::quiet_NaN());
    bool any = false;
    for (size_t i = 0; i < std::min(n, ids.size()); ++i)
        if (const Schedules* functions = of(i)) {
            const string name = string(engine) + ", function of time of body " + std::to_string(ids[i]);
            values[i] = (*functions)(static_cast<int>(i), time, name);
            any = true;
        }
    for (size_t i = 0; i < ids.size(); ++i)
        if (ids.size() != n || (of(i) && std::isnan(values[i])))
            throw std::runtime_error(string(engine) +
                                     ": a function of time added a body, or set the function of body " +
                                     std::to_string(ids[i]) + ": do that between two steps, by a PyRunner");
    return any;
}

bool isFunction(const py::object& value);

// A number that was given for `name` of a body; std::invalid_argument if it is none, with what else might be.
Real numberGiven(const py::object& value, const string& name, Body::id_t id, const char* wanted);

} // namespace yade

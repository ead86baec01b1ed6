// SPDX-License-Identifier: GPL-2.0-or-later
// Engines that move bodies with one freedom, such as sheaves and slides, which NewtonIntegrator sees as blocked.
#pragma once

#include "Mobility.hpp"

#include <lib/pyutil/gil.hpp>
#include <lib/serialization/Serializable.hpp>

#include <map>

namespace yade {

class Drive {
public:
    virtual ~Drive() = default;

    // Sets the velocities that are prescribed for the step ahead; nothing if that was done in this step.
    virtual void prepare(Scene& scene) = 0;

    // Adds how a body of ours answers; nothing for others.
    virtual void addMobility(Mobility& m, const Scene& scene, const Body& body) const = 0;

    // Adds to velocity and spin what a body of ours gains in this step by the force and torque, and by its drive and
    // friction.
    virtual void predict(Vector3r& velocity, Vector3r& spin, const Scene& scene, const Body& body,
                         const Vector3r& force, const Vector3r& torque) const = 0;
};

// All drives of a scene.
template <class F> void eachDrive(const Scene& scene, F f) {
    for (const auto& engine : scene.engines)
        if (auto* drive = dynamic_cast<Drive*>(engine.get()); drive && !engine->dead) f(*drive);
}

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

// A number, or a function of time that is called once to see that it works.
bool isFunction(const py::object& value);

} // namespace yade

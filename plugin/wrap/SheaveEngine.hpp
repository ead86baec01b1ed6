// SPDX-License-Identifier: GPL-2.0-or-later
// Turns sheaves about their axes.
#pragma once

#include "Drive.hpp"
#include "Guard.hpp"

#include <core/GlobalEngine.hpp>

#include <algorithm>
#include <limits>

extern "C" {
#include "ancf/rotor.h"
}

namespace yade {

class SheaveEngine : public GlobalEngine, public Drive {
    Schedules speeds, torques;
    int workIx = -1, lossIx = -1;

    [[noreturn]] void refuse(size_t i, const string& text) const;
    bool prescribed(size_t i) const { return scripted[i] == 1 || speed[i] == speed[i]; }
    ancf_rotor rotor(const State& state, size_t i) const { return {state.inertia[2], viscous[i], dry[i]}; }
    Vector3r axis(const State& state) const;
    void checkLists() const override;
    void check();
    void resize();
    void turn(size_t i);

public:
    void action() override;
    void postLoad(SheaveEngine&);
    void prepare(Scene& scene) override;
    const vector<Body::id_t>& bodies() const override { return ids; }
    bool turns(Body::id_t id) const override { return std::find(ids.begin(), ids.end(), id) != ids.end(); }
    bool places(Body::id_t) const override { return false; }
    void addMobility(Mobility& m, const Scene& scene, const Body& body) const override;
    void predict(Vector3r& velocity, Vector3r& spin, const Scene& scene, const Body& body, const Vector3r& force,
                 const Vector3r& torque) const override;

    int add(Body::id_t id, Real newViscous, Real newDry, const py::object& newTorque, const py::object& newSpeed);
    int number(Body::id_t id) const;
    void setSpeed(Body::id_t id, const py::object& value);
    void setTorque(Body::id_t id, const py::object& value);

    // clang-format off
    YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(SheaveEngine, GlobalEngine,
        "Turns bodies about their own z axis, sheaves above all: J w' = torques of contacts + drive - viscous w - dry, the "
        "frictions at the new speed; or at a prescribed speed. J is state.inertia[2]. The bodies are blocked in 'XYZ'; "
        "where they go is their own affair. After CableEngine, before NewtonIntegrator.",
        ((vector<int>, ids, , Attr::readonly, "Bodies that it turns."))
        ((vector<Real>, viscous, , Attr::triggerPostLoad, "Viscous friction of the bearings [N m s]."))
        ((vector<Real>, dry, , Attr::triggerPostLoad, "Dry friction of the bearings [N m]."))
        ((vector<Real>, torque, , Attr::triggerPostLoad, "Drive torques [N m]."))
        ((vector<Real>, speed, , Attr::triggerPostLoad, "Prescribed speeds [rad/s]; NaN: free."))
        ((vector<int>, scripted, , Attr::readonly, "1: the speed, 2: the torque is a Python function of time."))
        ((vector<int>, stuck, , Attr::readonly, "1 where dry friction holds."))
        ((vector<Real>, contactTorque, , Attr::readonly, "Torques of contacts in the last step [N m]."))
        ((vector<Real>, driveTorque, , Attr::readonly, "Torques of the drives in the last step, also where the speed is prescribed [N m]."))
        ((vector<Vector3r>, load, , Attr::readonly, "Forces of contacts on the sheaves in the last step [N]."))
        ((vector<Real>, angle, , Attr::readonly, "Angles turned so far [rad]."))
        ((vector<Real>, work, , Attr::readonly, "Work of the drives so far [J]."))
        ((vector<Real>, loss, , Attr::readonly, "Work of the bearings' friction so far [J].")),
        ,
        .def("add", &SheaveEngine::add, (py::arg("id"), py::arg("viscous") = 0., py::arg("dry") = 0., py::arg("torque") = 0., py::arg("speed") = py::object()),
             "Turns a body. torque and speed: numbers or functions of time [s]; speed None: free. Returns its number. ValueError on bad values.")
        .def("number", &SheaveEngine::number, (py::arg("id")), "Number of a body in the lists. ValueError if it is not ours.")
        .def("setSpeed", &SheaveEngine::setSpeed, (py::arg("id"), py::arg("speed")), "Prescribes the speed [rad/s]: a number, a function of time, or None (free).")
        .def("setTorque", &SheaveEngine::setTorque, (py::arg("id"), py::arg("torque")), "Sets the drive torque [N m]: a number or a function of time.")
        .def(Guarded())
    )
    // clang-format on
};
REGISTER_SERIALIZABLE(SheaveEngine);

} // namespace yade

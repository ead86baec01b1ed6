// SPDX-License-Identifier: GPL-2.0-or-later
// Moves bodies along straight guides: freely with friction and stops, or as a linear drive.
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

class GuideEngine : public GlobalEngine, public Drive {
    Schedules motions;
    Vector3r gravity = Vector3r::Zero();
    int workIx = -1, lossIx = -1;

    [[noreturn]] void refuse(size_t i, const string& text) const;
    Real place(size_t i) const;
    void checkLists() const override;
    void check();
    void resize();
    void slide(size_t i);

public:
    void action() override;
    void postLoad(GuideEngine&);
    void prepare(Scene& scene) override;
    const vector<Body::id_t>& bodies() const override { return ids; }
    bool turns(Body::id_t) const override { return false; }
    bool places(Body::id_t id) const override { return std::find(ids.begin(), ids.end(), id) != ids.end(); }
    void addMobility(Mobility& m, const Scene& scene, const Body& body) const override;
    void predict(Vector3r& velocity, Vector3r& spin, const Scene& scene, const Body& body, const Vector3r& force,
                 const Vector3r& torque) const override;

    int add(Body::id_t id, const Vector3r& newDirection, Real newFriction, Real newViscous, Real newLower,
            Real newUpper, const py::object& motion);
    int number(Body::id_t id) const;
    void setMotion(Body::id_t id, const py::object& motion);
    Real position(Body::id_t id) const;

    // clang-format off
    YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(GuideEngine, GlobalEngine,
        "Moves bodies along straight lines through where they were added: freely, with Coulomb friction that truly holds, "
        "viscous friction and end stops without rebound; or as linear drives, place x(t) given. The bodies are blocked in "
        "'xyz'. After CableEngine, before NewtonIntegrator.",
        ((vector<int>, ids, , Attr::readonly, "Bodies that it moves."))
        ((vector<Vector3r>, origin, , Attr::readonly, "Where they were added [m]."))
        ((vector<Vector3r>, direction, , Attr::readonly, "Unit vectors of their guides."))
        ((vector<Real>, friction, , Attr::triggerPostLoad, "Coulomb's coefficients [-]; the normal force is all that acts across the guide, gravity included."))
        ((vector<Real>, viscous, , Attr::triggerPostLoad, "Viscous friction [N s/m]."))
        ((vector<Real>, lower, , Attr::triggerPostLoad, "Lower stops [m] from the origin."))
        ((vector<Real>, upper, , Attr::triggerPostLoad, "Upper stops [m] from the origin."))
        ((vector<Real>, push, , Attr::triggerPostLoad, "Forces along the guides besides all others [N]."))
        ((vector<int>, driven, , Attr::readonly, "1 where the motion is prescribed."))
        ((vector<int>, held, , Attr::readonly, "1 where friction holds, 2 at the upper, -2 at the lower stop."))
        ((vector<Real>, rubbing, , Attr::readonly, "Bounds of dry friction in the last step [N]."))
        ((vector<Real>, lastSpeed, , Attr::readonly, "Speeds in the step before [m/s]."))
        ((vector<Real>, driveForce, , Attr::readonly, "Forces of the drives along their guides in the last step [N]."))
        ((vector<Real>, work, , Attr::readonly, "Work of drives and pushes so far [J]."))
        ((vector<Real>, loss, , Attr::readonly, "Work of friction and stops so far [J].")),
        ,
        .def("add", &GuideEngine::add, (py::arg("id"), py::arg("direction"), py::arg("friction") = 0., py::arg("viscous") = 0., py::arg("lower") = -std::numeric_limits<Real>::infinity(), py::arg("upper") = std::numeric_limits<Real>::infinity(), py::arg("motion") = py::object()),
             "Puts a body on a guide. motion: function of time [s] that gives the distance from where the body is now [m]; None: free. Returns its number. ValueError on bad values.")
        .def("number", &GuideEngine::number, (py::arg("id")), "Number of a body in the lists. ValueError if it is not ours.")
        .def("position", &GuideEngine::position, (py::arg("id")), "Distance of a body from its origin [m].")
        .def("setMotion", &GuideEngine::setMotion, (py::arg("id"), py::arg("motion")), "Prescribes the distance from the origin [m] as a function of time; None: free.")
        .def(Guarded())
    )
    // clang-format on
};
REGISTER_SERIALIZABLE(GuideEngine);

} // namespace yade

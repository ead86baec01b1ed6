// SPDX-License-Identifier: GPL-2.0-or-later
// A line that runs through rings at knots of cables and nets, or on bodies, drawn by winches at its ends.
#pragma once

#include "Drive.hpp"
#include "Guard.hpp"

#include <core/GlobalEngine.hpp>

#include <array>
#include <memory>

extern "C" {
#include "ancf/line.h"
}

namespace yade {

class CableEngine;

class LineEngine : public GlobalEngine {
    struct LineDeleter {
        void operator()(ancf_line* l) const { ancf_line_destroy(l); }
    };
    std::unique_ptr<ancf_line, LineDeleter> model;
    Schedules speeds;
    vector<CableEngine*> owner;     // (places) whose node it is, NULL for a body, since places were looked for last
    vector<std::array<Real, 3>> at; // (places) where they are [m]
    vector<CableEngine*> others;    // that are not in O.engines yet, while one asks
    vector<const LineEngine*> otherLines;
    bool sound = false;    // attributes are those that checkLists() let pass
    long checkedIter = -1; // of the last look at the step
    Real checkedStep = 0;  // that was found short enough then [s]
    int elasticIx = -1, frictionIx = -1, workIx = -1;

    [[noreturn]] void refuse(const string& text) const;
    string placeText(size_t i) const;
    Scene& theScene() const;
    CableEngine& cable(size_t i) const;
    const Body& bodyAt(size_t i) const;
    void checkLists() const;
    void needSound();
    void checkOrder() const;
    void checkPlaces() const;
    bool lookDue() const;
    void checkStep();
    class Handed;
    void layNow();
    CableEngine* findCable(int family) const;
    std::pair<int, int> moved(const LineEngine& line, size_t i) const;
    void makeLine();
    void takeState();
    void findPlaces();
    void askWinches();
    Vector3r pullAt(size_t i) const;
    void pullBodies();
    void pullCables();
    void noteEnergy();
    vector<Real> inverseMasses() const;
    int endNumber(int end) const;

public:
    void action() override;
    void postLoad(LineEngine&);

    vector<Real> ways(const py::object& cables);
    void setWinch(int end, const py::object& newSpeed, Real newForce, Real newBrake, Real newLeast, Real newMost);
    string doing(int end) const;
    Real criticalTimeStep(const py::object& engines);
    vector<Vector3r> points();
    Real elastic();
    Real wholeLength() const;

    // clang-format off
    YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(LineEngine, GlobalEngine,
        "A line without mass or bending stiffness through rings, in which its material slides: Eytelwein's friction at "
        "each, unstressed length passes from span to span, and onto the drums of winches at its ends. It touches nothing. "
        "Before CableEngine. Made by the Python class Line of the package ancf.",
        ((int, line, 0, Attr::readonly, "Number of this line, unique in the scene."))
        ((vector<int>, families, , Attr::readonly, "Of each place the number of the CableEngine whose node it is, or -1: a body."))
        ((vector<int>, numbers, , Attr::readonly, "Of each place the node, or the body."))
        ((vector<Vector3r>, offsets, , Attr::readonly, "Of places on bodies where, in the body's frame [m]."))
        ((Real, ea, 0, Attr::triggerPostLoad, "Axial stiffness [N]."))
        ((Real, ringRadius, 0, Attr::triggerPostLoad, "Size r of the rings: the way between two centres at the distance d is sqrt(d² + r²) [m]."))
        ((Real, diameter, 0, Attr::triggerPostLoad, "For pictures [m]."))
        ((string, name, "Line", , "In messages."))
        ((vector<Real>, friction, , Attr::triggerPostLoad, "Coefficients of friction of the places; those of the ends are not used [-]."))
        ((vector<Real>, length, , Attr::triggerPostLoad, "Unstressed lengths of the spans [m]."))
        ((vector<Real>, tension, , Attr::triggerPostLoad, "Tensions of the spans in the last step [N]."))
        ((vector<int>, slides, , Attr::readonly, "What the places did in the last step. Rings: 1 the line slides towards higher spans, -1 towards lower ones, 0 it sticks; ends: 0 holds, 1 draws, 2 strains at its force, 3 slips."))
        ((vector<Real>, flow, , Attr::readonly, "Unstressed length that passes a place towards higher spans in a time, in the last step [m/s]."))
        ((vector<Real>, speed, , Attr::triggerPostLoad, "Speeds at which the two ends draw in, below 0: let out [m/s]."))
        ((vector<Real>, force, , Attr::triggerPostLoad, "Tensions up to which they draw [N]."))
        ((vector<Real>, brake, , Attr::triggerPostLoad, "Tensions up to which they hold [N]; infinity: whatever comes."))
        ((vector<Real>, least, , Attr::triggerPostLoad, "Unstressed length of the whole line at which they stop to draw in [m]."))
        ((vector<Real>, most, , Attr::triggerPostLoad, "Unstressed length of the whole line at which they stop to let out by their speed [m]; infinity: never."))
        ((vector<int>, scripted, , Attr::readonly, "1 where the speed is a Python function of time."))
        ((Real, rubbed, 0, Attr::readonly, "Work of friction at the rings so far [J]."))
        ((Real, drawn, 0, Attr::readonly, "Work of the winches on the line so far, less the elastic energy of what they wound up [J]."))
        ((vector<Vector3r>, leftForce, , Attr::hidden, "Of places on bodies, what was rounded off their forces [N]."))
        ((vector<Vector3r>, leftTorque, , Attr::hidden, "And off their torques [N m]."))
        ((long, unsettled, 0, Attr::readonly, "Steps in which no state of all rings was found that agrees with every law.")),
        ,
        .add_property("elastic", &LineEngine::elastic, "Elastic energy [J].")
        .add_property("wholeLength", &LineEngine::wholeLength, "Unstressed length of all spans [m].")
        .def("ways", &LineEngine::ways, (py::arg("cables") = py::tuple()), "Ways of the spans where the places are now [m]. cables: CableEngines that are not in O.engines yet.")
        .def("points", &LineEngine::points, "Where the places are now [m].")
        .def("setWinch", &LineEngine::setWinch, (py::arg("end"), py::arg("speed"), py::arg("force"), py::arg("brake"), py::arg("least"), py::arg("most")), "What an end, 0 or -1, does. speed: a number or a function of time. ValueError on bad values.")
        .def("doing", &LineEngine::doing, (py::arg("end")), "What an end, 0 or -1, did in the last step: 'holds', 'draws', 'lets out', 'strains', 'slips' or 'stopped'.")
        .def("criticalTimeStep", &LineEngine::criticalTimeStep, (py::arg("engines") = py::tuple()), "Stable step of the line on what it and other lines pull at, those bodies being free otherwise [s]. engines: CableEngines and LineEngines that are not in O.engines yet.")
        .def(Guarded())
    )
    // clang-format on
};
REGISTER_SERIALIZABLE(LineEngine);

} // namespace yade

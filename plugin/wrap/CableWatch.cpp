// SPDX-License-Identifier: GPL-2.0-or-later
// What a scene must not be: out of order, or blind for pairs of bodies.
#include "CableEngine.hpp"

#include "CableCheck.hpp"
#include "text.hpp"

#include <core/InteractionLoop.hpp>
#include <lib/pyutil/gil.hpp>
#include <pkg/dem/NewtonIntegrator.hpp>

#include <cmath>

namespace yade {

// Pairs of bodies without functors, which YADE does not tell: the package's own check, in Python.
void CableEngine::checkPairs() const {
    gilLock lock;
    try {
        py::import("ancf.scene").attr("check")();
    } catch (const py::error_already_set&) {
        PyObject *type, *value, *trace;
        PyErr_Fetch(&type, &value, &trace);
        PyErr_NormalizeException(&type, &value, &trace);
        const py::handle<> held(value);
        Py_XDECREF(type);
        Py_XDECREF(trace);
        throw std::runtime_error(py::extract<string>(py::str(py::object(held)))());
    }
}

void CableEngine::checkScene() const {
    const Scene& s = theScene();
    if (s.isPeriodic) refuse("a periodic cell is not supported: set O.periodic = False");
    bool seen = false, moved = false;
    for (const auto& engine : s.engines) {
        if (engine.get() == this) {
            seen = true;
            if (moved) refuse("stands after NewtonIntegrator in O.engines: must stand before it");
        }
        if (dynamic_cast<const NewtonIntegrator*>(engine.get())) moved = true;
        if (seen && dynamic_cast<const InteractionLoop*>(engine.get()))
            refuse("stands before InteractionLoop in O.engines: must stand after it");
    }
}

void CableEngine::checkBodies() const {
    const Scene& s = theScene();
    const auto size = static_cast<Body::id_t>(s.bodies->size());
    const shared_ptr<Body>* bodies = size > 0 ? &(*s.bodies)[0] : nullptr; // one call, not one each
    bool all = true;
    for (const Body::id_t id : elementIds) all = all && (id < 0 || (id < size && bodies[id]));
    for (int e = 0; e < static_cast<int>(elementIds.size()) && !all; ++e)
        if (elementIds[e] >= 0) elementBody(e); // refuses one that is gone
    for (size_t i = 0; i < carryIds.size(); ++i)
        if (!s.bodies->exists(carryIds[i]))
            refuse(text("body ", carryIds[i], ", which node ", carryNodes[i],
                        " carries, was erased: its mass cannot be taken off a cable; let it live"));
    for (size_t i = 0; i < followIds.size(); ++i)
        if (!s.bodies->exists(followIds[i]))
            refuse(text("body ", followIds[i], ", which node ", followNodes[i],
                        " follows, was erased: release() the node first"));
}

// Bodies for which YADE would end at their first contact; told in our own step, as the collider cannot.
void CableEngine::checkPartners() {
    if (partnersChecked) return;
    CableCheck(*this).partners(0);
    partnersChecked = true;
}

void CableEngine::checkIntegrator() {
    mapBodies();
    if (integrator == "implicit") CableCheck(*this).implicit();
}

void CableEngine::check() {
    checkScene();
    const CableCheck check(*this);
    check.others();
    check.partners(0);
}

py::list CableEngine::overlaps(Real part) {
    if (!(part >= 0 && std::isfinite(part)))
        throw std::invalid_argument(text("CableEngine.overlaps: part = ", part, ": must be finite and not below 0"));
    if (!model) build();
    model->x = position.data();
    py::list all;
    for (const Overlap& one : CableCheck(*this).overlaps(part))
        all.append(py::make_tuple(one.first, one.second, one.at, one.depth, one.radius));
    return all;
}

} // namespace yade

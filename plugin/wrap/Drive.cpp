// SPDX-License-Identifier: GPL-2.0-or-later
#include "Drive.hpp"

#include "CableElement.hpp"

#include <pkg/dem/NewtonIntegrator.hpp>

#include <boost/weak_ptr.hpp>

#include <algorithm>
#include <cmath>

namespace yade {

namespace {
    struct Known {
        vector<DriveEngine> drives;
        vector<const NewtonIntegrator*> newtons; // the last one first
    };

    const Known& knownOf(const Scene& scene) {
        thread_local vector<boost::weak_ptr<Engine>> seen; // weak: an engine's address may be used again
        thread_local Known found;
        const auto same = [](const boost::weak_ptr<Engine>& a, const shared_ptr<Engine>& b) {
            return !a.owner_before(b) && !b.owner_before(a);
        };
        if (std::equal(seen.begin(), seen.end(), scene.engines.begin(), scene.engines.end(), same)) return found;
        seen.assign(scene.engines.begin(), scene.engines.end());
        found = Known();
        for (const auto& engine : scene.engines) {
            if (auto* drive = dynamic_cast<Drive*>(engine.get())) found.drives.push_back({engine.get(), drive});
            if (const auto* newton = dynamic_cast<const NewtonIntegrator*>(engine.get()))
                found.newtons.insert(found.newtons.begin(), newton);
        }
        return found;
    }
} // namespace

const vector<DriveEngine>& drivesOf(const Scene& scene) { return knownOf(scene).drives; }

const NewtonIntegrator* newtonOf(const Scene& scene) {
    for (const NewtonIntegrator* newton : knownOf(scene).newtons)
        if (!newton->dead) return newton;
    return nullptr;
}

void checkDriven(const Scene& scene, Body::id_t id, const string& name) {
    if (!scene.bodies->exists(id)) throw std::invalid_argument(name + " does not exist");
    const Body& body = *(*scene.bodies)[id];
    if (CableElement::of(body)) throw std::invalid_argument(name + " is an element of a cable: hold its nodes instead");
    if (body.isClumpMember())
        throw std::invalid_argument(name + " is a clump's member: take the clump, " + std::to_string(body.clumpId));
}

Schedules::~Schedules() {
    if (functions.empty() || !Py_IsInitialized()) return;
    gilLock lock;
    functions.clear();
}

void Schedules::set(int number, const py::object& function) {
    gilLock lock;
    functions.erase(number);
    if (!function.is_none()) functions[number] = function;
}

namespace {
    // What Python raised, as text; clears it.
    string pythonError() {
        PyObject *type, *value, *trace;
        PyErr_Fetch(&type, &value, &trace);
        PyErr_NormalizeException(&type, &value, &trace);
        string text = "unknown error";
        if (PyObject* shown = value ? PyObject_Repr(value) : nullptr) {
            if (const char* letters = PyUnicode_AsUTF8(shown)) text = letters;
            Py_DECREF(shown);
        }
        PyErr_Clear();
        Py_XDECREF(type);
        Py_XDECREF(value);
        Py_XDECREF(trace);
        return text;
    }
} // namespace

namespace {
    // A thread that Python does not know, as that of O.run, would else be made known and forgotten in each call.
    void keepThreadState() {
        if (PyGILState_GetThisThreadState()) return;
        PyGILState_Ensure();
        PyEval_SaveThread();
    }
} // namespace

Real Schedules::operator()(int number, Real time, const string& name) const {
    keepThreadState();
    gilLock lock;
    Real value;
    try {
        value = py::extract<Real>(functions.at(number)(time));
    } catch (const py::error_already_set&) {
        throw std::runtime_error(name + " at t = " + std::to_string(time) + ": " + pythonError());
    }
    if (!std::isfinite(value)) throw std::runtime_error(name + " at t = " + std::to_string(time) + " is not finite");
    return value;
}

bool isFunction(const py::object& value) { return PyCallable_Check(value.ptr()); }

} // namespace yade

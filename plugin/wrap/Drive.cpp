// SPDX-License-Identifier: GPL-2.0-or-later
#include "Drive.hpp"

#include "CableElement.hpp"

#include <core/InteractionLoop.hpp>
#include <core/Omega.hpp>
#include <pkg/common/Collider.hpp>
#include <pkg/dem/NewtonIntegrator.hpp>

#include <boost/weak_ptr.hpp>

#include <algorithm>
#include <cmath>

namespace yade {

const KnownEngines& knownEngines(const Scene& scene) {
    thread_local vector<boost::weak_ptr<Engine>> seen; // weak: an engine's address may be used again
    thread_local KnownEngines found;
    const auto same = [](const boost::weak_ptr<Engine>& a, const shared_ptr<Engine>& b) {
        return !a.owner_before(b) && !b.owner_before(a);
    };
    if (std::equal(seen.begin(), seen.end(), scene.engines.begin(), scene.engines.end(), same)) return found;
    seen.assign(scene.engines.begin(), scene.engines.end());
    found = KnownEngines();
    for (const auto& engine : scene.engines) {
        if (auto* drive = dynamic_cast<Drive*>(engine.get())) found.drives.push_back({engine.get(), drive});
        if (const auto* newton = dynamic_cast<const NewtonIntegrator*>(engine.get()))
            found.newtons.insert(found.newtons.begin(), newton);
        if (const auto* loop = dynamic_cast<const InteractionLoop*>(engine.get())) found.loops.push_back(loop);
        if (const auto* collider = dynamic_cast<const Collider*>(engine.get())) found.colliders.push_back(collider);
    }
    return found;
}

const NewtonIntegrator* newtonOf(const Scene& scene) {
    for (const NewtonIntegrator* newton : knownEngines(scene).newtons)
        if (!newton->dead) return newton;
    return nullptr;
}

void Drive::needSound() const {
    if (sound) return;
    checkLists();
    sound = true;
}

void Drive::takeLists() {
    sound = false;
    needSound();
    const vector<Body::id_t>& ids = bodies();
    for (size_t i = 0; i < ids.size(); ++i)
        if (ids[i] >= static_cast<int>(numberOfBody.size()) || numberOfBody[ids[i]] != static_cast<int>(i))
            preparedIter = -1; // other bodies
    if (preparedIter < 0) numberOfBody.clear();
}

void Drive::numberBodies(const Scene& scene) {
    const vector<Body::id_t>& ids = bodies();
    numberOfBody.assign(scene.bodies->size(), -1);
    for (size_t i = 0; i < ids.size(); ++i) numberOfBody[ids[i]] = static_cast<int>(i);
}

bool Drive::prepared(const Scene& scene) const {
    return preparedIter == scene.iter && numberOfBody.size() == scene.bodies->size();
}

int Drive::numberOf(const Body& body) const {
    if (!sound) return -1;
    if (body.id < static_cast<int>(numberOfBody.size())) return numberOfBody[body.id];
    const vector<Body::id_t>& ids = bodies(); // before a first step, and of bodies that came after the last
    const auto found = std::find(ids.begin(), ids.end(), body.id);
    return found == ids.end() ? -1 : static_cast<int>(found - ids.begin());
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
    // A scene that the function leaves has to live until the step that called it is over.
    static auto* const left = new shared_ptr<Scene>;
    const shared_ptr<Scene> scene = Omega::instance().getScene();
    Real value;
    try {
        const py::object function = functions.at(number); // it may set another one
        value = py::extract<Real>(function(time));
    } catch (const py::error_already_set&) {
        throw std::runtime_error(name + " at t = " + std::to_string(time) + ": " + pythonError());
    }
    if (Omega::instance().getScene() != scene) {
        *left = scene;
        throw std::runtime_error(name + " left the scene (O.reset, O.load or the like): do that between two steps");
    }
    if (!std::isfinite(value)) throw std::runtime_error(name + " at t = " + std::to_string(time) + " is not finite");
    return value;
}

bool isFunction(const py::object& value) { return PyCallable_Check(value.ptr()); }

Real numberGiven(const py::object& value, const string& name, Body::id_t id, const char* wanted) {
    const py::extract<Real> number(value);
    if (number.check()) return number();
    const string given = py::extract<string>(value.attr("__repr__")());
    throw std::invalid_argument(name + " = " + given + " of body " + std::to_string(id) + ": must be " + wanted);
}

} // namespace yade

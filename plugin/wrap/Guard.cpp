// SPDX-License-Identifier: GPL-2.0-or-later
#include "Guard.hpp"

#include <core/Omega.hpp>

#include <boost/python/raw_function.hpp>

#include <atomic>
#include <chrono>
#include <mutex>
#include <stdexcept>
#include <thread>

namespace yade {

namespace py = boost::python;

namespace {
    std::recursive_timed_mutex turn;
    std::atomic<int> waiting {0};

    // Waits by a function, without Python's interpreter lock.
    template <class F> bool await(F lock) {
        const bool locked = Py_IsInitialized() && PyGILState_Check();
        PyThreadState* const state = locked ? PyEval_SaveThread() : nullptr;
        ++waiting;
        const bool held = lock();
        --waiting;
        if (locked) PyEval_RestoreThread(state);
        return held;
    }
} // namespace

Guard::Guard() {
    if (turn.try_lock()) return;
    await([] {
        turn.lock();
        return true;
    });
}

Guard::~Guard() { turn.unlock(); }

PatientGuard::PatientGuard()
    : held(turn.try_lock() || await([] { return turn.try_lock_for(std::chrono::milliseconds(20)); })) {}

PatientGuard::~PatientGuard() {
    if (held) turn.unlock();
}

StepGuard::Turn::Turn() {
    while (waiting.load(std::memory_order_relaxed) > 0 && !(Py_IsInitialized() && PyGILState_Check()))
        std::this_thread::yield();
}

// YADE's thread is none that Python has started.
void refuseWhileRunning(const std::string& what) {
    if (!Omega::instance().isRunning()) return;
    const py::object threading = py::import("threading"), mine = threading.attr("current_thread")();
    if (PyObject_IsInstance(mine.ptr(), py::object(threading.attr("_DummyThread")).ptr())) return;
    throw std::runtime_error(what + ": not while the simulation runs: O.pause() first, and O.run() again afterwards");
}

namespace {
    struct GuardedCall {
        py::object function;
        py::object operator()(const py::tuple& positional, const py::dict& keywords) const {
            const Guard guard;
            return py::object(py::handle<>(PyObject_Call(function.ptr(), positional.ptr(), keywords.ptr())));
        }
    };

    py::object guarded(const py::object& function) {
        if (function.is_none()) return function;
        py::object call = py::raw_function(GuardedCall {function}, 1);
        call.attr("__doc__") = py::object(function.attr("__doc__"));
        return call;
    }
} // namespace

void Guarded::guardAll(const py::object& cls) {
    const py::object propertyType(py::handle<>(py::borrowed(reinterpret_cast<PyObject*>(&PyProperty_Type))));
    const py::dict own(cls.attr("__dict__"));
    const py::list names(own.attr("keys")());
    for (py::ssize_t i = 0; i < py::len(names); ++i) {
        const py::object value = own[names[i]];
        const std::string name = py::extract<std::string>(names[i]);
        if (name[0] == '_') continue;
        if (PyObject_IsInstance(value.ptr(), propertyType.ptr()))
            py::setattr(cls, names[i],
                        propertyType(guarded(py::object(value.attr("fget"))), guarded(py::object(value.attr("fset"))),
                                     py::object(), py::object(value.attr("__doc__"))));
        else if (PyCallable_Check(value.ptr())) py::setattr(cls, names[i], guarded(value));
    }
    for (const char* inherited : {"updateAttrs", "dict"})
        if (!own.contains(inherited)) py::setattr(cls, py::str(inherited), guarded(py::object(cls.attr(inherited))));
}

} // namespace yade

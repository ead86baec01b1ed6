// SPDX-License-Identifier: GPL-2.0-or-later
// Steps of our engines and calls of them from Python take turns: O.run goes on in a thread of its own.
#pragma once

#include <lib/base/Math.hpp>

#include <boost/python.hpp>

namespace yade {

// Held by one thread at a time, as often as it likes: a step may call a Python function of time, which may call the
// engine. Python's interpreter lock is given away while one waits for it, as the other may need that to go on.
class Guard {
public:
    Guard();
    ~Guard();
    Guard(const Guard&) = delete;
    Guard& operator=(const Guard&) = delete;
};

// The same for one who would rather leave something out than wait for long: false if it is not to be had.
class PatientGuard {
    const bool held;

public:
    PatientGuard();
    ~PatientGuard();
    PatientGuard(const PatientGuard&) = delete;
    PatientGuard& operator=(const PatientGuard&) = delete;
    explicit operator bool() const { return held; }
};

// In a step: lets those go first who wait, as steps follow one another too closely for them.
class StepGuard {
    struct Turn {
        Turn();
    } turn;
    Guard guard;
};

// RuntimeError while O.run goes on in another thread: what YADE itself cannot do then, such as to append bodies.
void refuseWhileRunning(const std::string& what);

// Lets whatever Python does with objects of a class hold the Guard: all attributes and methods that it has of its own,
// and what it inherits to set and show them. The last of its definitions: .def(Guarded())
class Guarded : public boost::python::def_visitor<Guarded> {
    friend class boost::python::def_visitor_access;
    static void guardAll(const boost::python::object& cls);
    template <class C> void visit(C& cls) const { guardAll(cls); }
};

} // namespace yade

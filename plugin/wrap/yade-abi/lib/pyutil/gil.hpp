// SPDX-License-Identifier: GPL-2.0-or-later
// Holds Python's interpreter lock for a scope. Never inside an OpenMP region: O.step() would hang.
#pragma once

#include <boost/python/detail/wrap_python.hpp>

#include <string>

class gilLock {
    PyGILState_STATE state_ = PyGILState_Ensure();

public:
    gilLock() = default;
    gilLock(const gilLock&) = delete;
    gilLock& operator=(const gilLock&) = delete;
    ~gilLock() { PyGILState_Release(state_); }
};

void pyRunString(const std::string& command, bool ignoreErrors = false, bool updateGlobals = false);

// SPDX-License-Identifier: GPL-2.0-or-later
// Numbers of a Python array (numpy's float64 or int32), read where they are: lists would be copied item by item, and
// YADE's converter of lists never gives their items back.
#pragma once

#include "text.hpp"

#include <lib/base/Math.hpp>

#include <boost/python.hpp>

#include <stdexcept>

namespace yade {

template <class T> class Numbers {
    static constexpr char kind = std::is_same_v<T, double> ? 'd' : 'i';
    static_assert(std::is_same_v<T, double> || std::is_same_v<T, int>);
    Py_buffer array;

public:
    Numbers(const boost::python::object& given, const char* name) {
        if (PyObject_GetBuffer(given.ptr(), &array, PyBUF_C_CONTIGUOUS | PyBUF_FORMAT) != 0)
            boost::python::throw_error_already_set();
        const bool good = array.format[0] == kind && array.format[1] == 0;
        if (!good) PyBuffer_Release(&array);
        if (!good)
            throw std::invalid_argument(
                text(name, ": must be a contiguous array of ", kind == 'd' ? "float64" : "int32"));
    }
    Numbers(const Numbers&) = delete;
    Numbers& operator=(const Numbers&) = delete;
    ~Numbers() { PyBuffer_Release(&array); }

    size_t size() const { return static_cast<size_t>(array.len) / sizeof(T); }
    const T* begin() const { return static_cast<const T*>(array.buf); }
    const T* end() const { return begin() + size(); }
    const T& operator[](size_t i) const { return begin()[i]; }
};

} // namespace yade

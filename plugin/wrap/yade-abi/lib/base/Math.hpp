// SPDX-License-Identifier: GPL-2.0-or-later
// Number and vector types of the packaged YADE in double precision.
#pragma once

// The package is built with these; without them Quaternionr is aligned to 16 and every class behind it moves.
#if !defined(EIGEN_DONT_ALIGN) || !defined(EIGEN_DONT_VECTORIZE)
#error "compile with -DEIGEN_DONT_ALIGN -DEIGEN_DONT_VECTORIZE"
#endif

#include <boost/python.hpp>

#include <boost/lexical_cast.hpp>
#include <boost/preprocessor.hpp>
#include <boost/serialization/is_bitwise_serializable.hpp>
#include <boost/serialization/nvp.hpp>
#include <boost/shared_ptr.hpp>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cassert>
#include <cmath>
#include <iostream>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <lib/base/AliasNamespaces.hpp>

#define YADE_PTR_CAST ::boost::static_pointer_cast
#define YADE_PTR_DYN_CAST ::boost::dynamic_pointer_cast
#define YADE_CAST static_cast

namespace yade {

using boost::shared_ptr;
using std::cerr;
using std::cout;
using std::endl;
using std::invalid_argument;
using std::logic_error;
using std::make_pair;
using std::pair;
using std::runtime_error;
using std::string;
using std::swap;
using std::vector;

using Real = double;
using mask_t = int;

using Vector2r = Eigen::Matrix<Real, 2, 1>;
using Vector3r = Eigen::Matrix<Real, 3, 1>;
using Vector6r = Eigen::Matrix<Real, 6, 1>;
using Matrix3r = Eigen::Matrix<Real, 3, 3>;
using Vector2i = Eigen::Matrix<int, 2, 1>;
using Vector3i = Eigen::Matrix<int, 3, 1>;
using Quaternionr = Eigen::Quaternion<Real>;
using AngleAxisr = Eigen::AngleAxis<Real>;

template <class Scalar> class Se3 {
public:
    Eigen::Matrix<Scalar, 3, 1> position;
    Eigen::Quaternion<Scalar> orientation;

    Se3() {}
    Se3(Eigen::Matrix<Scalar, 3, 1> p, Eigen::Quaternion<Scalar> q) : position(p), orientation(q) {}
};
using Se3r = Se3<Real>;

constexpr Real NaN = std::numeric_limits<Real>::quiet_NaN();

} // namespace yade

BOOST_IS_BITWISE_SERIALIZABLE(yade::Vector2r)
BOOST_IS_BITWISE_SERIALIZABLE(yade::Vector3r)
BOOST_IS_BITWISE_SERIALIZABLE(yade::Vector6r)
BOOST_IS_BITWISE_SERIALIZABLE(yade::Matrix3r)
BOOST_IS_BITWISE_SERIALIZABLE(yade::Vector2i)
BOOST_IS_BITWISE_SERIALIZABLE(yade::Vector3i)
BOOST_IS_BITWISE_SERIALIZABLE(yade::Quaternionr)
BOOST_IS_BITWISE_SERIALIZABLE(yade::Se3r)

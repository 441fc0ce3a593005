// A plain C++ loop over Pinocchio: Jacobian, K_C, the compliance J (K_theta - K_C)^-1 J^T of the
// point and its principal values. Built and run by bench_roads.py:
//   pinocchio_loop ARM POSES(n x 6 doubles) SECONDS VALUES(n x 3 doubles, out)
// prints poses per second: the best of as many runs as fit into the time, at least three.
#include <chrono>
#include <fstream>
#include <iostream>
#include <iterator>
#include <string>
#include <vector>

#include <Eigen/Dense>
#include <pinocchio/algorithm/frames.hpp>
#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/multibody.hpp>

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Matrix63 = Eigen::Matrix<double, 6, 3>;

// Per joint its placement (3 × 4, by rows) and its axis, then the placement of the end frame. The
// joints are of the kinds that Pinocchio's URDF parser chooses.
pinocchio::Model read(const char* path) {
  std::ifstream text(path);
  const auto placement = [&text] {
    Eigen::Matrix<double, 3, 4> T;
    for (int i = 0; i < 3; ++i) for (int j = 0; j < 4; ++j) text >> T(i, j);
    return pinocchio::SE3(Eigen::Matrix3d(T.leftCols<3>()), Eigen::Vector3d(T.col(3)));
  };
  pinocchio::Model model;
  pinocchio::JointIndex last = 0;
  for (int k = 0; k < 6; ++k) {
    const pinocchio::SE3 T = placement();
    Eigen::Vector3d axis;
    text >> axis(0) >> axis(1) >> axis(2);
    const std::string name = "j" + std::to_string(k);
    if (axis.isApprox(Eigen::Vector3d::UnitX())) last = model.addJoint(last, pinocchio::JointModelRX(), T, name);
    else if (axis.isApprox(Eigen::Vector3d::UnitY())) last = model.addJoint(last, pinocchio::JointModelRY(), T, name);
    else if (axis.isApprox(Eigen::Vector3d::UnitZ())) last = model.addJoint(last, pinocchio::JointModelRZ(), T, name);
    else last = model.addJoint(last, pinocchio::JointModelRevoluteUnaligned(axis), T, name);
  }
  model.addFrame(pinocchio::Frame("end", last, 0, placement(), pinocchio::OP_FRAME));
  return model;
}

int main(int, char** argv) {
  const pinocchio::Model model = read(argv[1]);
  pinocchio::Data data(model);
  const auto frame = model.getFrameId("end");
  std::ifstream file(argv[2], std::ios::binary);
  const std::vector<char> bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  const auto* first = reinterpret_cast<const double*>(bytes.data());
  const long count = static_cast<long>(bytes.size() / (6 * sizeof(double)));
  const double seconds = std::stod(argv[3]);
  const Eigen::Vector3d force(300.0, -200.0, 400.0);
  Matrix6 K_theta = Matrix6::Zero();
  for (int j = 0; j < 6; ++j) K_theta(j, j) = 1.4e6 + (4e5 - 1.4e6) * j / 5.0;
  std::vector<double> values(3 * count);

  const auto work = [&] {
    Eigen::VectorXd q(6);
    pinocchio::Data::Matrix6x full(6, 6);
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
    for (long k = 0; k < count; ++k) {
      q = Eigen::Map<const Eigen::Matrix<double, 6, 1>>(first + 6 * k);
      full.setZero();
      pinocchio::computeFrameJacobian(model, data, q, frame, pinocchio::LOCAL_WORLD_ALIGNED, full);
      const Matrix6 J = full;
      Matrix6 K = K_theta;
      for (int i = 0; i < 6; ++i) {
        const Eigen::Vector3d w = J.block<3, 1>(3, i), turned = force.cross(w);
        for (int j = i; j < 6; ++j) {
          const double K_C = turned.dot(J.block<3, 1>(0, j));
          K(i, j) -= K_C;
          if (j > i) K(j, i) -= K_C;
        }
      }
      const Matrix63 Jv = J.topRows<3>().transpose();
      const Eigen::Matrix3d C = Jv.transpose() * K.llt().solve(Jv);
      solver.computeDirect(C);
      for (int i = 0; i < 3; ++i) values[3 * k + i] = 1.0 / solver.eigenvalues()(2 - i);
    }
  };

  using clock = std::chrono::steady_clock;
  work();
  double best = 1e300;
  const auto end = clock::now() + std::chrono::duration<double>(seconds);
  for (int runs = 0; runs < 3 || clock::now() < end; ++runs) {
    const auto begin = clock::now();
    work();
    best = std::min(best, std::chrono::duration<double>(clock::now() - begin).count());
  }
  std::ofstream out(argv[4], std::ios::binary);
  out.write(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(double));
  std::cout << count / best << std::endl;
}

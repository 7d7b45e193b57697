// Small SQLite and HDF5 files for tests, written by their own libraries, with selectable defects.
#pragma once

#include <hdf5.h>
#include <sqlite3.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace throng {

inline void make_sqlite(const std::filesystem::path& file, const std::string& sql) {
  std::filesystem::remove(file);
  sqlite3* database = nullptr;
  sqlite3_open(file.c_str(), &database);
  sqlite3_exec(database, "PRAGMA synchronous = OFF", nullptr, nullptr, nullptr);
  sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr);
  sqlite3_close(database);
}

/// Database as JuPedSim 1.3 writes it: two people who walk for three frames.
inline std::string jupedsim_2() {
  return "CREATE TABLE trajectory_data(frame INTEGER NOT NULL, id INTEGER NOT NULL, pos_x REAL NOT "
         "NULL, pos_y REAL NOT NULL, ori_x REAL NOT NULL, ori_y REAL NOT NULL);"
         "CREATE TABLE metadata(key TEXT NOT NULL UNIQUE PRIMARY KEY, value TEXT NOT NULL);"
         "CREATE TABLE geometry(hash INTEGER NOT NULL, wkt TEXT NOT NULL);"
         "CREATE TABLE frame_data(frame INTEGER NOT NULL, geometry_hash INTEGER NOT NULL);"
         "INSERT INTO metadata VALUES('version', '2'), ('fps', '25.0');"
         "INSERT INTO geometry VALUES(77, 'POLYGON ((-2 -2, 8 -2, 8 8, -2 8))');"
         "INSERT INTO frame_data VALUES(0, 77), (1, 77), (2, 77);"
         "INSERT INTO trajectory_data VALUES(0, 1, 0, 0, 0, 0), (0, 5, 1, 1, 1, 0), "
         "(1, 1, 0.05, 0, 0, 1), (1, 5, 1.05, 1, 1, 0), (2, 1, 0.1, 0, 0, 1);";
}

struct Hdf5Row {
  int32_t id, frame;
  double x, y, z;
};

struct Hdf5Plan {
  std::vector<Hdf5Row> rows = {{1, 10, 0, 0, 1.75}, {1, 11, 0.05, 0, 1.74}, {2, 10, 3, 3, 1.9}};
  std::string dataset = "trajectory";
  std::string x_name = "x";
  double fps = 25;  ///< 0: none
  std::string wkt{};
  std::vector<std::pair<std::string, std::string>> texts{};  ///< attributes of the dataset
  bool has_z = true;
  bool id_is_real = false;
};

inline void make_hdf5(const std::filesystem::path& path, const Hdf5Plan& plan) {
  const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const hid_t type = H5Tcreate(H5T_COMPOUND, sizeof(Hdf5Row));
  H5Tinsert(type, "id", HOFFSET(Hdf5Row, id),
            plan.id_is_real ? H5T_NATIVE_FLOAT : H5T_NATIVE_INT32);
  H5Tinsert(type, "frame", HOFFSET(Hdf5Row, frame), H5T_NATIVE_INT32);
  H5Tinsert(type, plan.x_name.c_str(), HOFFSET(Hdf5Row, x), H5T_NATIVE_DOUBLE);
  H5Tinsert(type, "y", HOFFSET(Hdf5Row, y), H5T_NATIVE_DOUBLE);
  if (plan.has_z) H5Tinsert(type, "z", HOFFSET(Hdf5Row, z), H5T_NATIVE_DOUBLE);
  const hsize_t count = plan.rows.size();
  const hid_t space = H5Screate_simple(1, &count, nullptr);
  const hid_t dataset =
      H5Dcreate2(file, plan.dataset.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  if (count > 0) H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, plan.rows.data());
  const hid_t one = H5Screate(H5S_SCALAR);
  if (plan.fps != 0) {
    const hid_t fps = H5Acreate2(dataset, "fps", H5T_NATIVE_DOUBLE, one, H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(fps, H5T_NATIVE_DOUBLE, &plan.fps);
    H5Aclose(fps);
  }
  const auto write_text = [&](hid_t object, const std::string& name, const std::string& value) {
    const hid_t text = H5Tcopy(H5T_C_S1);
    H5Tset_size(text, H5T_VARIABLE);
    const hid_t attribute = H5Acreate2(object, name.c_str(), text, one, H5P_DEFAULT, H5P_DEFAULT);
    const char* characters = value.c_str();
    H5Awrite(attribute, text, static_cast<const void*>(&characters));
    H5Aclose(attribute);
    H5Tclose(text);
  };
  if (!plan.wkt.empty()) write_text(file, "wkt_geometry", plan.wkt);
  for (const auto& [name, value] : plan.texts) write_text(dataset, name, value);
  H5Sclose(one);
  H5Dclose(dataset);
  H5Sclose(space);
  H5Tclose(type);
  H5Fclose(file);
}

}  // namespace throng

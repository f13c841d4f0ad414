# Embeds the names of variables of known aircraft in the library.
pcor_embed(pcor_offline ${CMAKE_CURRENT_BINARY_DIR}/aircraft_data.cpp pcor::internal::aircraft
  ncar ${PROJECT_SOURCE_DIR}/data/aircraft/ncar.toml
  faam_core ${PROJECT_SOURCE_DIR}/data/aircraft/faam-core.toml
  halo_bahamas ${PROJECT_SOURCE_DIR}/data/aircraft/halo-bahamas.toml
  noaa_wp_3d ${PROJECT_SOURCE_DIR}/data/aircraft/noaa-wp-3d.toml
  wyoming_king_air ${PROJECT_SOURCE_DIR}/data/aircraft/wyoming-king-air.toml)

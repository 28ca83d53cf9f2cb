# What a wheel has beside the modules of tools/reflux, in the folder of the package: `cmake --install TREE --component wheel`, which
# pyproject.toml asks for. tools/reflux/paths.py finds it there.
set(wheel COMPONENT wheel EXCLUDE_FROM_ALL)
install(TARGETS reflux-host reflux-sim reflux-sim-memory libreflux libreflux_board libreflux_lab
  RUNTIME DESTINATION reflux/programs ${wheel} LIBRARY DESTINATION reflux/programs ${wheel})
install(DIRECTORY host_sim/plants DESTINATION reflux ${wheel} FILES_MATCHING PATTERN "*.json")
install(DIRECTORY host_sim/scenarios DESTINATION reflux ${wheel} FILES_MATCHING PATTERN "*.toml" PATTERN "*.conf" PATTERN "*.wiring")

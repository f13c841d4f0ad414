# Which rooms (folders of include/pcor, src and tests) make up which library. tests/rooms/floors.txt says which room
# may include which.
set(pcor_realtime_rooms physics model effects realtime)
set(pcor_model_rooms words units laws)
set(pcor_offline_rooms numerics team regimes report flight simulate batch roles residuals process campaign compare diagnose checks inspect fit
  improve temperature)

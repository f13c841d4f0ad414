# Modules (folders of include/pcor, src and tests) of each library. tests/architecture/layers.txt lists the
# modules that each module may include.
set(pcor_realtime_modules physics model effects realtime)
set(pcor_model_modules base units model_io)
set(pcor_offline_modules numerics parallel regimes report flight simulate batch roles residuals process campaign compare diagnose checks inspect
  fit improve temperature)

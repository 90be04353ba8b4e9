"""Texts of configurations that several tests need."""

#: A configuration that nothing realises: `A` requires what cannot be made from the data of `B`.
IMPOSSIBLE = """\
@configuration
@modules A, B, C
A uses_data_from B NotifyWhenReady
C uses_data_from B
@module_start
@module_name B
@Sense RequestWhenReady
Image look();
@module_end
"""
#: An error at line 5, a warning at line 3, notes at lines 3 and 7.
FINDINGS = """\
@configuration hierarchical
@modules A, B, Base, Camera, Arm
Base is_controlled_by A 1
Base is_controlled_by B 1
Arm is_mounted_on Arm
A uses_data_from Camera
B uses_data_from Camera
"""

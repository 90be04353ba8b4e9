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

"""A study of 24 runs, drawn as contacts against the number of people."""
import matplotlib.pyplot as plt

import throng

study = throng.study("plaza", seeds=range(1, 5), seconds=2, parameters={
    "avatars": [100, 200, 300], "groups.*.desired_speed_mps.mean": [1.0, 1.4]})
for speed_mps, runs in study.to_pandas().groupby("groups.*.desired_speed_mps.mean"):
    contacts = runs.groupby("avatars").contacts_per_person_min.agg(["mean", "std"])
    plt.errorbar(contacts.index, contacts["mean"], contacts["std"], label=f"{speed_mps} m/s")
plt.legend(), plt.xlabel("people"), plt.ylabel("contacts per person and minute")
plt.savefig("study_plot.png")

"""Marker sets that the dictionary of names was tested on before it knew them, written as in known_sets.py."""

HELD_OUT = {
    # github.com/koonyook/rris40, markers.md
    "rris40": {
        "head": "#TEMP #HEAD",
        "torso": "#ACR STER XPRO C7 T10 T4 T8",
        "upper_arm": "#HLE #HME",
        "forearm": "#RSP #USP",
        "hand": "#CAP #HMC2",
        "pelvis": "#ASIS #PSIS #ICR",
        "thigh": "#FLE #FME",
        "shank": "#TAM #FAL",
        "foot": "#FCC #FMT1 #FMT5 #FMT2",
    },
    # github.com/opensim-org/opensim-core, JAM example, static1.trc
    "jam_knee": {
        "torso": "#.Shoulder #.Clavicle L.Scapula",
        "upper_arm": "#.Bicep #.Elbow #.Melb",
        "forearm": "#.Forearm #.Wrist",
        "pelvis": "#.ASIS #.PSIS S2",
        "thigh": "#.TH1 #.TH2 #.TH3 L.TH4 #.Knee #.GTR #.Mkn",
        "shank": "#.SH1 #.SH2 #.SH3 R.SH4 #.Ankle #.Man",
        "foot": "#.Heel #.MT5",
    },
    # github.com/RealTimeBiomechanics/rtosim, ik_taskset.xml
    "rtosim": {
        "torso": "#ACR C7 T10 CLAV STRN #ASH #PSH",
        "pelvis": "#ASI #PSI #HJC",
        "thigh": "#THU #THC #THD #FCL #FCM #THM",
        "shank": "#TBU #TBC #TBD #TBL #MALL #MALM #TCL #TCM #KJC",
        "foot": "#CAL #MT1 #MT5",
    },
    # a viewer of gait captures with this set (github, labeledSegments)
    "proximal_distal": {
        "head": "#FHD #BHD",
        "torso": "#ACR #SHO",
        "pelvis": "#ILCR #ASIS #PSIS MID_HJC MID_ASIS MID_PSIS",
        "upper_arm": "#LEB #MEB",
        "forearm": "#LWRT #MWRT",
        "hand": "#HAND",
        "thigh": "#GTR #THI #LEP #MEP",
        "shank": "#LMAL #MMAL #PSK #DSK",
        "foot": "#HEEL #MET5 #TOE",
    },
    # pyCGM2, upper limb (Model_UpperLimb.vst)
    "pycgm2_upper_limb": {
        "torso": "C7 T10 CLAV STRN #SHO",
        "upper_arm": "#UPA #UPB #UPC #ELB #MEP",
        "forearm": "#FRA #WRA #WRB",
        "hand": "#FIN",
    },
    # dos Santos & Duarte, PeerJ 4 (2016) e2648: balance, after Leardini
    "bmc_balance": {
        "head": "#.Front.Head #.Back.Head",
        "torso": "#.Shoulder C7 T2 T7 IJ PX",
        "pelvis": "L3 L5 #.ASIS #.PSIS #.Iliac.Crest",
        "thigh": "#.GRT #.Knee #.Knee.Medial",
        "shank": "#.HF #.TT #.Ankle #.Ankle.Medial",
        "foot": "#.Heel #.MT1 #.MT5 #.MT2",
    },
    # MoVi (Ghorbani et al., PLoS ONE 16 (2021) e0253157), markers of the body only
    "movi": {
        "head": "%fronthead %backhead %cheek",
        "torso": "backneck upperback clavicle sternum %back %shom %breast %scapula",
        "upper_arm": "%upperarm %elbm %elbinner",
        "forearm": "%forearm %writhumbside %wripinkieside",
        "hand": "%fin %thumb",
        "pelvis": "%asis %psis %bum",
        "thigh": "%frontthigh %thigh %knem %frontinnerthigh %innerknee",
        "shank": "%ankm %shin",
        "foot": "#Heel %fifthmetatarsal %firstmetatarsal",
        "toes": "#BigToe %fourthtoe",
    },
    # CMU (mocap.cs.cmu.edu)
    "cmu": {
        "head": "#FHD #BHD",
        "torso": "STRN CLAV T10 C7 RBAC #SHO",
        "upper_arm": "#UPA #ELB",
        "forearm": "#FRM #WRA #WRB",
        "hand": "#FIN",
        "pelvis": "#BWT #FWT",
        "thigh": "#THI #KNE",
        "shank": "#SHN #ANK",
        "foot": "#HEE #TOE #MT5",
    },
    # Wojtusch & von Stryk, HuMoD (Humanoids 2015)
    "humod": {
        "head": "TRA_# GLA",
        "torso": "C7 T8 T12 SUP ACR_#",
        "upper_arm": "LHC_#",
        "forearm": "WRI_#",
        "pelvis": "ASIS_# PSIS_# PS",
        "thigh": "GTR_# LFC_# MFC_#",
        "shank": "LM_# MM_#",
        "foot": "MT2_# MT5_# CAL_#",
        "toes": "HAL_#",
    },
    # Fukuchi et al., PeerJ 5 (2017) e3298: running
    "fukuchi_running": {
        "pelvis": "#ASIS #PSIS #ILC",
        "thigh": "#TTL #TBL #TTM #TBM #GTR #KNL #KNM",
        "shank": "#STL #SBL #STM #SBM #HFB #TTU #AKL #AKM",
        "foot": "#HET #HEB #HEL #MT1 #MT5 #MT2",
    },
    # Moissenet, InitialiseMarkerTrajectories
    "geneva_legs": {
        "pelvis": "#ASI #PSI",
        "thigh": "#GTR #THAP #THAD #THI1 #THI2 #KNE #KNM",
        "shank": "#FAX #TTA #TIAP #TIAD #TIB1 #TIB2 #ANK #MED",
        "foot": "#HEE #TOE #FMH #SMH #VMH",
    },
    # MAP client, gias2: pelvis and legs in one laboratory
    "map_client": {
        "torso": "C7 T10 CLAV STRN #SHO BackExtra",
        "upper_arm": "#TRI #ELB",
        "forearm": "#WRI",
        "pelvis": "#ASI VSAC #ILC #PSI",
        "thigh": "#GTR #KNE #KNM",
        "shank": "#S1 #S2 #S3 #ANK #ANM",
        "foot": "#HEE",
    },
    # BTS, Milan: running
    "bts_running": {
        "foot": "%Heel %Meta5 %Meta1",
        "shank": "%MalMed %MalExt",
        "thigh": "%KneeMed %KneeExt %Troc",
        "pelvis": "%ASIS %PSIS L2",
        "upper_arm": "%ElbMed %ElbExt",
        "forearm": "%WriMed %WriExt",
        "torso": "%Acro C7 cla",
    },
    # walking of young and old adults, Brazil (c3d_to_trc.py)
    "kneelat": {
        "pelvis": "#ASIS #PSIS",
        "thigh": "#THI #KNEELAT #KNEEMED",
        "shank": "#FIB #TIB #ANKLELAT #ANKLEMED",
        "foot": "#HEEL #TOEMED #TOELAT",
        "torso": "C7 CLAV T2",
    },
    # a robot's belt at the knee: R.TibTub and Plug-in Gait
    "tibtub": {
        "thigh": "#KNE #KNEEMED #THI",
        "shank": "#TIB #.TibTub #ANK #ANKMED",
        "foot": "#1MT #HEEL",
        "pelvis": "#ASI #PSI",
    },
}
"""Public sets that were read before their spellings went into the dictionary: 89 % of the names, 3.4 % of the sure
readings on a wrong segment."""


HELD_OUT_LATER = {
    # walking in OpenSim (github, set_up_ik_tool)
    "ik_study": {
        "torso": "Sternum #Shoulder",
        "pelvis": "#ASIS #PSIS",
        "shank": "#Fibula #Shank #AnkleLateral #AnkleMedial",
        "foot": "#MT5 #MT2 #Heel",
        "thigh": "#KneeLateral #KneeMedial",
    },
    # MAP client, gias2: a second laboratory
    "map_client_words": {
        "pelvis": "#Asis #Psis",
        "thigh": "#KneeLateral #KneeMedial #ThighSuperior #ThighInferior #ThighLateral",
        "shank": "#AnkleLateral #AnkleMedial #ShankSuperior #ShankInferior #ShankLateral",
        "torso": "#Shoulder",
        "foot": "#Heel #MidfootLateral",
    },
    # BioBuddy, lower limbs after Maldonado et al. 2018
    "biobuddy_legs": {
        "head": "#FHD #BHD",
        "torso": "C7 T10 CLAV STRN RBAK #SHO",
        "upper_arm": "#ELB #HUM",
        "forearm": "#WRA #WRB",
        "hand": "#FIN",
        "pelvis": "#ASI #PSI",
        "thigh": "#THI #THID #KNE #KNM #TROC",
        "shank": "#TIB #TIBP #TIBD #ANK #ANKM",
        "foot": "#HEE #TOE #5MH",
        "": "*51",
    },
    # running, Hamburg (github, markers_needed)
    "hamburg": {
        "pelvis": "#ASI #PSI",
        "thigh": "#TRO #KNE #KNEM",
        "shank": "#TIB #ANK #ANKM",
        "foot": "#CALL #CALM #HEE #LMT5 #LMT1 #TOE",
    },
    # lifting, a digital twin: box, sensors and a plate beside the body
    "lifting_twin": {
        "upper_arm": "#ELBL #ELBM",
        "forearm": "#WRL #WRM",
        "thigh": "#KNE",
        "shank": "#ANKL #ANKM",
        "foot": "#TOE #HEE",
        "pelvis": "#ASI #PSI",
        "torso": "MChest",
        "": "Box1 Box2 Box3 Box4 DL1 DL2 DL3 DH1 DH2 DH3",
    },
    "static_text": {
        "pelvis": "#_ASIS V_Sacral",
        "thigh": "#_Knee #_Knee_Med #_Thigh",
        "shank": "#_Ankle #_Ankle_Med #_Shank",
        "foot": "#_Heel #_Toe",
    },
    # a body in MATLAB after OpenSim
    "matlab_body": {
        "forearm": "#FAsuperior #WristMed #WristLat",
        "thigh": "#ThighUpper #ThighFront #ThighRear #KneeLat #KneeMed",
        "shank": "#ShankUpper #ShankFront #ShankRear #AnkleLat #AnkleMed",
        "foot": "#Heel #ToeLat #MidToeLat #MidToeMed #MidfootSup #MidfootLat",
        "toes": "#ToeTip",
    },
    # Waterloo, inertial sensors beside markers
    "waterloo": {
        "torso": "#_Shoulder",
        "pelvis": "#_ASIS",
        "thigh": "#_Knee_Med #_Knee_Lat",
        "shank": "#_Ankle_Med #_Ankle_Lat",
        "foot": "#_Toe #_Heel",
    },
    # names that a converter of captures looks for
    "converter": {
        "thigh": "#_FemCon_Med #_FemCon_Lat",
        "shank": "#_MedMalleolus #_LatMalleolus",
        "forearm": "#_WR_rad #_WR_uln",
        "upper_arm": "#_EL_med #_EL_lat",
        "foot": "#_1st_met #_5th_met #_calc",
        "pelvis": "#_HJC_reg",
    },
    # markers on an SMPL body
    "smpl_markers": {
        "head": "head_top head_front head_back",
        "torso": "sternum c7 t10 %_acromion",
        "pelvis": "sacrum %_asis %_psis",
        "upper_arm": "%_elbow_lat %_elbow_med",
        "forearm": "%_wrist",
        "thigh": "%_knee_lat %_knee_med",
        "shank": "%_ankle_lat %_ankle_med",
        "foot": "%_heel %_toe",
    },
    # Camargo et al., J. Biomech. 119 (2021) 110320
    "camargo": {
        "pelvis": "#_ASIS #_PSIS",
        "thigh": "#_Thigh_Front #_Thigh_Rear #_Thigh_Upper #_Knee_Lat",
        "shank": "#_Shank_Front #_Shank_Rear #_Shank_Upper #_Ankle_Lat",
        "foot": "#_Heel #_Toe_Lat #_Toe_Med",
        "toes": "#_Toe_Tip",
    },
    # opensim-core, FAIDC1_INITIAL_WALK01.trc: medial epicondyles of the knee
    "sandbox_walk": {
        "torso": "#SH C7",
        "upper_arm": "#ELB",
        "forearm": "#WR",
        "pelvis": "#ASI SACR",
        "thigh": "#THLP #THLD #THAP #THAD #LEPI #MEPI",
        "shank": "#TIAP #TIAD #TILAT #LMAL #MMAL",
        "foot": "#HEEL #MFS #MFL #P5MT #P1MT #TOE",
    },
}
"""Public sets of a second round, read when the spellings of the first were in and their own were not: 95 % of the
names, none of the 323 sure readings on a wrong segment."""

HELD_OUT_LAST = {
    # forward and backward marks on the limbs (github, Lmrk)
    "hyphens": {
        "pelvis": "#ASI #PSI #PEL",
        "torso": "#SHO CLAV STRN T10 C7",
        "thigh": "#THI #KNE #TRO #KNE-M #THI-B #THI-F",
        "shank": "#TIB #ANK #ANK-M #TIB-B #TIB-F",
        "foot": "#HEE #TOE #MET5 #MET1",
    },
    # Lenton, treadmill (github, grf_assign_treadmill_Lenton)
    "treadmill_lkn": {
        "pelvis": "#ASI #PSI",
        "thigh": "#THI1 #THI2 #THI3 #LKN",
        "shank": "#SHA1 #SHA2 #SHA3 #LMAL",
        "foot": "#HEEL #MET5 #MET1",
    },
    # SIMM's names for OrthoTrak
    "orthotrak": {
        "pelvis": "VSacral #ASIS #PSIS",
        "thigh": "#KneeLat #KneeMed #GreaterTroc",
        "shank": "#AnkleLat #AnkleMed",
        "foot": "#Heel #Toe",
        "torso": "#Shoulder",
        "upper_arm": "#ElbowLat #ElbowMed",
        "forearm": "#WristLat #WristMed #WristFront #WristBack",
        "head": "HeadRear HeadTop HeadFront HeadFrontRight HeadFrontLeft HeadBackRight HeadBackLeft",
        "hand": "#MiddleFinger #Thumb",
    },
    # Motive columns (github)
    "body_prefix": {
        "forearm": "Body_#Ulna Body_#Radius",
        "upper_arm": "Body_#ElbowMedial Body_#Elbow",
        "torso": "Body_#Shoulder",
    },
    # markers added to the points of a video system (github)
    "video_markers": {
        "torso": "Sternum #Shoulder C7 T6 T11",
        "upper_arm": "#ElbowLat #ElbowMed",
        "forearm": "#WristLat #WristMed",
        "pelvis": "#ASIS #PSIS L2",
        "thigh": "#KneeLat #KneeMed",
        "shank": "#AnkleLat #AnkleMed",
        "foot": "#5Meta #Heel",
        "toes": "#BigToe",
    },
}
"""Public sets of a third round: 99 % of the names, none of the 146 sure readings on a wrong segment."""

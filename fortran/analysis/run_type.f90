!> A run between two increments: what evolves, the workspace, and what was reported so far.
module lopin_run_type
   use lopin_kinds, only : wp
   use lopin_checksum, only : checksum_type
   use lopin_report, only : frame_type, summary_type, energy_type
   use lopin_loading, only : loading_type
   use lopin_plan, only : plan_type
   use lopin_scene, only : scene_type
   use lopin_after_step, only : seen_type
   use lopin_judge_drift, only : drift_type
   use lopin_artificial_work, only : artificial_type
   use lopin_work_balance, only : balance_type
   implicit none
   private
   public :: run_type, progress_type, march_type

   !> What goes on from step to step.
   type :: progress_type
      real(wp) :: time = 0.0_wp
      real(wp), allocatable :: steady(:)       !! (ndof) loads to go on from
      real(wp), allocatable :: f(:), residual(:)
      real(wp) :: work = 0.0_wp                !! of loads and prescribed displacements
      real(wp) :: most = 0.0_wp                !! energy that was about
      type(seen_type) :: seen                  !! how near the pairs came
      type(drift_type) :: drift                !! bodies that nothing has stopped
      type(artificial_type) :: artificial      !! work of what held floating bodies
      type(balance_type) :: balance            !! work that is lost
      real(wp), allocatable :: f_before(:), u_before(:), r_before(:)
      type(checksum_type) :: checksum          !! of the displacements of all nodes so far
   end type progress_type

   !> How far a step has gone.
   type :: march_type
      type(loading_type) :: loading
      integer :: number = 0                    !! increments accepted
      real(wp) :: time = 0.0_wp                !! of the step, reached [time]
      real(wp) :: increment = 0.0_wp           !! to be tried next [time]
      real(wp) :: parts_until = 0.0_wp         !! time of the step up to which it goes by parts
      real(wp) :: part = 0.0_wp                !! of an increment in which contact began [time]
      logical :: at_end = .false.              !! the last increment of the step is accepted
      type(energy_type) :: energy              !! of the last increment
   end type march_type

   type :: run_type
      type(scene_type), allocatable :: scene   !! may be made again at any time from the rest
      type(plan_type) :: plan
      type(progress_type) :: progress
      type(march_type) :: march
      type(summary_type) :: summary
      type(frame_type) :: frame                !! the last increment that was accepted
      logical :: in_step = .false.             !! a step is begun and not ended
      logical :: may_step = .false.            !! opened, without an error so far
   end type run_type
end module lopin_run_type

!> The first increment of a step whose deck leaves its length open: sized by the strain of first
!> yield.
!>
!> The whole step as one increment is right for what stays elastic. Where the metal flows, Newton
!> would spend tens of iterations on it before it is cut. Its first steps show already how far the
!> metal would flow: if that is more than a few strains of first yield, the increment is cut to
!> where it is not.
module lopin_first_increment
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise
   use lopin_text, only : to_text
   use lopin_model, only : model_type
   use lopin_state, only : solids_state_type
   use lopin_recover_nonlinear, only : remember
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: opens_step, size_first, first_flow, first_id, flows_far

   character(len=*), parameter :: first_id = 'E0515'
   !> Plastic strain of a first increment: so many strains of first yield; where nothing yields.
   real(wp), parameter :: yields = 5.0_wp, without_yield = 0.02_wp
   !> Steps of Newton that are looked at; least share that an increment is cut to at once.
   integer, parameter :: first_looks = 3
   real(wp), parameter :: least_fit = 0.005_wp
   !> Cuts to fit: what flows as much in any increment, as where a force is let go of at once, is
   !> not sized by its flow.
   integer, parameter :: most_sizes = 8

contains

   !> The increment to come is the first of a step that says nothing of its length.
   pure logical function opens_step(scene, model)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model

      associate (step => model%step(scene%step))
         opens_step = .not. (step%direct .or. step%initial < step%period) &
            & .and. scene%newton%flows .and. .not. scene%accepted%clock%time > 0.0_wp
      end associate
   end function opens_step

   !> Cut what flows too far in the trial after these many steps of Newton; `finite%fit` says where
   !> to.
   subroutine size_first(scene, model, taken, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: taken             !! steps of Newton
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: flow, most

      if (taken > first_looks .or. .not. scene%may_cut) return
      if (.not. opens_step(scene, model) .or. scene%newton%sized >= most_sizes) return
      flow = flow_of_trial(scene, model)
      most = first_flow(model)
      if (flow <= most) return
      scene%newton%fit = max(least_fit, most/flow)
      call raise(error, error_code%not_converged, first_id, 'the first increment would flow by '// &
         & to_text(flow, 3)//', more than '//to_text(most, 3), &
         & model%step(scene%step)%at, help='the first datum of *STATIC is an increment of your own')
   end subroutine size_first

   !> The trial flows by more than a strain of first yield: a smaller increment is another problem,
   !> what is lost to contact node by node is not.
   logical function flows_far(scene, model)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model

      flows_far = flow_of_trial(scene, model) > first_flow(model)/yields
   end function flows_far

   !> Largest plastic strain of the increment in the trial.
   real(wp) function flow_of_trial(scene, model) result(flow)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      type(solids_state_type) :: trial

      trial = scene%trial%solids
      call remember(scene%solids, model%mesh, scene%trial%motion%u, scene%accepted%solids, trial)
      flow = trial%most_strain
   end function flow_of_trial

   !> Plastic strain that a first increment may have.
   pure real(wp) function first_flow(model)
      type(model_type), intent(in) :: model
      integer :: i

      first_flow = 0.0_wp
      do i = 1, size(model%material)
         associate (m => model%material(i))
            if (m%young > 0.0_wp) first_flow = max(first_flow, yields*m%yield/m%young)
         end associate
      end do
      if (.not. first_flow > 0.0_wp) first_flow = without_yield
      first_flow = min(first_flow, without_yield)
   end function first_flow
end module lopin_first_increment

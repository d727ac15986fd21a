!> Why a contact problem has no answer: motions that nothing holds, sets that cycle, multipliers
!> that converge too slowly.
module lopin_contact_failure
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise
   use lopin_plural, only : plural
   use lopin_text, only : to_text
   use lopin_model, only : model_type
   use lopin_body_words, only : describe_motion
   use lopin_active_set, only : outcome
   use lopin_condensed, only : condensed_type, form_compliance
   use lopin_dense, only : symmetric_eigen
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: check_held, explain_outcome

   !> Springs this much stiffer than the bodies leave three digits of a gap.
   real(wp), parameter :: no_digits_left = 1.0e13_wp

contains

   !> Motions that no row resists cannot be held by any contact.
   subroutine check_held(scene, model, error)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      real(wp), allocatable :: gram(:, :), value(:)
      integer :: status

      associate (p => scene%problem)
         if (p%nq == 0) return
         allocate (value(p%nq))
         gram = matmul(transpose(p%c), p%c)
         call symmetric_eigen(gram, value, status)
         if (value(1) > 1.0e-10_wp*max(value(p%nq), 1.0e-3_wp)) return
         call raise(error, error_code%singular, 'E0310', describe_motion(scene%bodies, &
            & model, gram(:, 1))//': neither a support nor a contact resists it', &
            & model%step(scene%step)%at, &
            & note=motions_note(scene), &
            & help='fix a degree of freedom by *BOUNDARY; without friction a contact '// &
            & 'does not hold what slides along it')
      end associate
   end subroutine check_held

   function motions_note(scene) result(text)
      type(scene_type), intent(in) :: scene
      character(len=:), allocatable :: text
      text = plural(scene%bodies%nq, 'motion')//' not held by supports'
   end function motions_note

   !> The outcome of the active set as an error; none if it solved the problem.
   subroutine explain_outcome(scene, model, error)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: motion
      real(wp) :: excess

      if (scene%answer%outcome == outcome%not_held &
         & .or. scene%answer%outcome == outcome%cycling) then
         excess = stiffness_excess(scene)
         if (excess > no_digits_left) then
            call raise(error, error_code%not_converged, 'E0501', 'the stiffness of contact is '// &
               & to_text(excess)// &
               & ' times that of the bodies: no digits are left of the gaps', &
               & model%step(scene%step)%at, &
               & help='a smaller slope, or DIRECT; PERTURBED LAGRANGE solves the same '// &
               & 'equations without this loss')
            return
         end if
      end if
      select case (scene%answer%outcome)
      case (outcome%solved)
      case (outcome%not_held)
         motion = describe_motion(scene%bodies, model, scene%answer%q)
         call raise(error, error_code%singular, 'E0310', motion// &
            & ': the contacts do not hold it under this load', model%step(scene%step)%at, &
            & note='no set of contacts that only press balances the loads', &
            & help='add a support, or turn the load so that it presses the bodies together')
      case (outcome%cycling)
         call raise(error, error_code%not_converged, 'E0501', 'the contact states do not '// &
            & 'settle in '//to_text(scene%answer%iterations)//' iterations', &
            & model%step(scene%step)%at, &
            & note='the energy falls with every change: what is left is rounding', &
            & help='check the units and the stiffnesses of materials and contacts: some differ '// &
            & 'by so much that no digits are left of the gaps')
      case (outcome%not_augmented)
         call raise(error, error_code%not_converged, 'E0502', &
            & 'the multipliers still move after '//to_text(scene%answer%augmentations)// &
            & ' augmentations (contraction '// &
            & to_text(real(nint(1000.0_wp*scene%answer%rate), wp)/1000.0_wp)//')', &
            & model%step(scene%step)%at, &
            & help='raise the stiffness or MAX AUGMENTATIONS=, or leave the stiffness out: it '// &
            & 'is '// &
            & 'then chosen')
      case default
         call raise(error, error_code%internal, 'E0901', 'the contact problem broke down')
      end select
   end subroutine explain_outcome

   !> Largest stiffness of a contact row over that of the bodies behind it.
   real(wp) function stiffness_excess(scene) result(excess)
      type(scene_type), intent(in) :: scene
      type(condensed_type) :: problem
      integer :: row

      excess = 0.0_wp
      if (.not. allocated(scene%problem%l)) return
      problem = scene%problem
      call form_compliance(problem)
      do row = 1, problem%nrow
         excess = max(excess, problem%alpha(row)*problem%s(row, row))
      end do
   end function stiffness_excess
end module lopin_contact_failure

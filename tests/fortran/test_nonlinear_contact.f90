!> Histories of contact on the present shape: what is rejected leaves no trace.
program test_nonlinear_contact
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, log_type
   use lopin_deck, only : deck_type, read_deck_text
   use lopin_model, only : model_type
   use lopin_build_model, only : new_model
   use lopin_dofs, only : dofs_type, new_dofs
   use lopin_friction, only : law_of
   use lopin_enforcement_factory, only : method_names, new_enforcement
   use lopin_nonlinear_contact, only : nonlinear_contact_type, new_nonlinear_contact, cover_size
   use lopin_contact_history, only : start_increment, augment, leave_history
   use lopin_state, only : state_type, begin, accept, reject, new_contact_state
   use lopin_contact_evaluation, only : evaluate_contact
   use contact_scenes, only : scene_names, scene_text
   use check, only : test, is_true, close_to, finish
   implicit none

   integer :: scene, method

   do scene = 1, size(scene_names)
      do method = 1, size(method_names)
         call rejected(trim(scene_names(scene)), method)
      end do
   end do
   call finish()

contains

   subroutine rejected(name, method)
      character(len=*), intent(in) :: name
      integer, intent(in) :: method
      type(deck_type) :: deck
      type(model_type) :: model
      type(log_type) :: log
      type(dofs_type) :: dofs
      type(error_type), allocatable :: error
      type(nonlinear_contact_type) :: contact
      type(state_type) :: accepted, trial
      real(wp), allocatable :: u(:, :), z(:, :), force(:), row(:)
      integer :: i

      call test('a rejected increment of '//name//', '//trim(method_names(method))// &
         & ', leaves no trace')
      call read_deck_text(deck, scene_text(name, '', '', 1), 'scene.inp', '', log, error)
      if (.not. allocated(error)) call new_model(model, deck, error)
      call is_true('the deck is read', .not. allocated(error))
      if (allocated(error)) return
      do i = 1, size(model%interaction)
         call new_enforcement(model%interaction(i)%method, trim(method_names(method)))
      end do
      model%interaction%friction%law = law_of%coulomb
      model%interaction%friction%mu = 0.3_wp
      call new_dofs(dofs, model)
      call new_nonlinear_contact(contact, model, dofs, log, error)
      call is_true('the contact is made', .not. allocated(error))
      if (allocated(error)) return
      call new_contact_state(accepted%contact, contact%nmultiplier, cover_size(contact), &
         & contact%touches)
      call begin(trial, accepted)
      allocate (u(dofs%n, 3), z(contact%nmultiplier, 3))
      call random_number(u)
      u = 0.05_wp*(u - 0.5_wp)
      ! Bodies and tools touch at a point at the start: they are to meet more of each other.
      do i = 1, merge(contact%n, 0, size(model%tool) == 0)
         associate (dof => dofs%id(model%mesh%ndim, contact%node(i)))
            u(dof, :) = u(dof, :) - 0.15_wp
         end associate
      end do
      do i = 1, size(model%rigid_body)
         u(dofs%id(2, model%rigid_body(i)%reference), :) = -0.4_wp + 0.1_wp*u(1, :)
      end do
      call random_number(z)
      z = 1.0e4_wp*(z - 0.5_wp)
      call run(contact, model, accepted, u, z, 1)
      call leave_history(contact, accepted%contact, trial%contact)
      call accept(accepted, trial)
      call run(contact, model, accepted, u, z, 2)
      force = contact%force
      row = contact%row
      call is_true('something presses', any(abs(force) > 0.0_wp))
      call close_to('forces balance', [(sum(contact%force, mask=dofs%dof == i), i=1, 2)] &
         & /maxval(abs(force)), [0.0_wp, 0.0_wp], 1.0e-12_wp)
      call reject(trial, accepted)
      call run(contact, model, accepted, u, z, 3)
      call is_true('another try presses otherwise', any(abs(contact%force - force) > 0.0_wp))
      call reject(trial, accepted)
      call run(contact, model, accepted, u, z, 2)
      call is_true('forces', all(abs(contact%force - force) <= 0.0_wp))
      call is_true('rows', all(abs(contact%row - row) <= 0.0_wp))
   end subroutine rejected

   !> An increment from state 1 (the first: from rest), with one augmentation.
   subroutine run(contact, model, accepted, u, z, to)
      type(nonlinear_contact_type), intent(inout) :: contact
      type(model_type), intent(in) :: model
      type(state_type), intent(in) :: accepted
      real(wp), intent(in) :: u(:, :), z(:, :)
      integer, intent(in) :: to
      type(error_type), allocatable :: error
      real(wp) :: change, beyond, nil(size(contact%gap))

      nil = 0.0_wp
      if (to == 1) then
         call start_increment(contact, model, accepted%contact, 0.0_wp*u(:, 1), 0.5_wp, error)
      else
         call start_increment(contact, model, accepted%contact, u(:, 1), 0.5_wp, error)
      end if
      call evaluate_contact(contact, model, u(:, to), z(:, to), .true., error)
      call augment(contact, nil(:contact%n), change, beyond)
      call evaluate_contact(contact, model, u(:, to), z(:, to), .true., error)
   end subroutine run
end program test_nonlinear_contact

!> Parts of a deck that nothing refers to: most often the line that would is forgotten.
!>
!> Tools, interactions and requests for contact output without a pair are warned of; materials and
!> amplitudes are noted, since programs that write decks list more than they use.
module lopin_check_unused
   use lopin_error, only : severity, location_type
   use lopin_text, only : upper
   use lopin_model, only : model_type, output_type, output_of, surface_of
   use lopin_pair_activity, only : asks_pair, is_named
   use lopin_block, only : deck_type, get_parameter
   implicit none
   private
   public :: check_unused

contains

   subroutine check_unused(model, deck)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck

      call check_tools(model)
      call check_rigid_meshes(model)
      call check_interactions(model)
      call check_pairs(model)
      call check_requests(model)
      call check_materials(model)
      call check_amplitudes(model, deck)
   end subroutine check_unused

   !> A tool touches through its pairs only.
   subroutine check_tools(model)
      type(model_type), intent(inout) :: model
      integer :: i

      do i = 1, size(model%surface)
         associate (surface => model%surface(i))
            if (surface%kind /= surface_of%tool .or. surface%tool == 0) cycle
            if (any(model%pair%master == i)) cycle
            call model%log%say(severity%warning, 'W0303', 'tool '//surface%name// &
               & ' is in no contact pair: bodies pass through it', surface%at, &
               & help='name it as the master of a *CONTACT PAIR, or remove it')
         end associate
      end do
   end subroutine check_tools

   !> A rigid mesh touches through its faces, or holds the body that shares its nodes.
   subroutine check_rigid_meshes(model)
      type(model_type), intent(inout) :: model
      logical :: serves(model%mesh%nnode)
      integer :: i

      if (.not. any([(size(model%rigid_body(i)%node) > 0, i=1, size(model%rigid_body))])) return
      call find_serving(model, serves)
      do i = 1, size(model%rigid_body)
         associate (body => model%rigid_body(i))
            if (size(body%node) == 0 .or. body%tool > 0) cycle
            if (any(serves(body%node))) cycle
            call model%log%say(severity%warning, 'W0303', 'rigid body '//body%name// &
               & ' is in no contact pair, and shares no node with a body that deforms: it '// &
               & 'touches nothing', body%at, help='name its faces as the master of a *CONTACT '// &
               & 'PAIR, or remove it')
         end associate
      end do
   end subroutine check_rigid_meshes

   !> Nodes of bodies that deform, of surfaces in pairs, of equations.
   subroutine find_serving(model, serves)
      type(model_type), intent(in) :: model
      logical, intent(out) :: serves(:)      !! (nnode)
      integer :: e, i, k

      serves = .false.
      do e = 1, model%mesh%nelement
         if (model%mesh%section(e) > 0) call take(e)
      end do
      do i = 1, size(model%surface)
         if (.not. (any(model%pair%master == i) .or. any(model%pair%slave == i))) cycle
         associate (surface => model%surface(i))
            if (allocated(surface%node)) serves(surface%node) = .true.
            if (.not. allocated(surface%element)) cycle
            do k = 1, size(surface%element)
               call take(surface%element(k))
            end do
         end associate
      end do
      do i = 1, size(model%equation)
         serves(model%equation(i)%node) = .true.
      end do
      do i = 1, size(model%spring)
         do k = 1, 2
            if (model%spring(i)%node(k) > 0) serves(model%spring(i)%node(k)) = .true.
         end do
      end do

   contains

      subroutine take(element)
         integer, intent(in) :: element
         integer :: j

         do j = 1, size(model%mesh%conn, 1)
            if (model%mesh%conn(j, element) > 0) serves(model%mesh%conn(j, element)) = .true.
         end do
      end subroutine take
   end subroutine find_serving

   subroutine check_interactions(model)
      type(model_type), intent(inout) :: model
      integer :: i

      do i = 1, size(model%interaction)
         if (any(model%pair%interaction == i)) cycle
         associate (interaction => model%interaction(i))
            if (index(interaction%name, '*TIE ') == 1) cycle
            call model%log%say(severity%warning, 'W0303', 'surface interaction '// &
               & interaction%name//' is in no contact pair: what it says of contact acts nowhere', &
               & interaction%at, help='*CONTACT PAIR, INTERACTION='//interaction%name// &
               & ' uses it; or remove it')
         end associate
      end do
   end subroutine check_interactions

   !> Pairs that *MODEL CHANGE takes away at the start and no step puts back.
   subroutine check_pairs(model)
      type(model_type), intent(inout) :: model
      logical :: active(size(model%pair)), acts(size(model%pair))
      type(location_type) :: at(size(model%pair))
      integer :: s, i

      active = .true.
      acts = .false.
      do s = 1, size(model%step)
         do i = 1, size(model%step(s)%pair_change)
            associate (change => model%step(s)%pair_change(i))
               active(change%pair) = change%active
               at(change%pair) = change%at
            end associate
         end do
         acts = acts .or. active
      end do
      do i = 1, size(model%pair)
         if (acts(i)) cycle
         call model%log%say(severity%warning, 'W0303', 'pair ('// &
            & model%surface(model%pair(i)%slave)%name//', '// &
            & model%surface(model%pair(i)%master)%name//') is taken out in the first step and '// &
            & 'never put back: it acts nowhere', at(i), help='*MODEL CHANGE, TYPE=CONTACT '// &
            & 'PAIR, ADD in a later step, or leave the pair out')
      end do
   end subroutine check_pairs

   !> *CONTACT PRINT of surfaces that are no pair.
   subroutine check_requests(model)
      type(model_type), intent(inout) :: model
      integer :: s, i, k

      do s = 1, size(model%step)
         do i = 1, size(model%step(s)%output)
            associate (output => model%step(s)%output(i))
               if (all(output%kind /= [output_of%contact_print, output_of%contact_file])) cycle
               if (output%slave == 0 .and. output%master == 0) cycle
               if (any([(asks_pair(model, output, k), k=1, size(model%pair))])) cycle
               ! Steps go on with the requests of those before.
               if (any([(model%log%item(k)%id == 'W0350' .and. model%log%item(k)%at%line &
                  & == output%at%line .and. model%log%item(k)%at%file == output%at%file, &
                  & k=1, model%log%n)])) cycle
               call model%log%say(severity%warning, 'W0350', 'no pair has '// &
                  & asked_roles(model, output)//': this request prints nothing', output%at, &
                  & help=pairs_of_request(model, output))
            end associate
         end do
      end do
   end subroutine check_requests

   !> "slave A and master B", as they are asked for.
   function asked_roles(model, output) result(text)
      type(model_type), intent(in) :: model
      type(output_type), intent(in) :: output
      character(len=:), allocatable :: text

      text = ''
      if (output%slave > 0) text = 'slave '//model%surface(output%slave)%name
      if (output%slave > 0 .and. output%master > 0) text = text//' and '
      if (output%master > 0) text = text//'master '//model%surface(output%master)%name
   end function asked_roles

   !> The pairs in which a surface of the request stands, or all.
   function pairs_of_request(model, output) result(text)
      type(model_type), intent(in) :: model
      type(output_type), intent(in) :: output
      character(len=:), allocatable :: text
      logical :: named(size(model%pair))
      integer :: i

      named = [(has(model%pair(i)%slave) .or. has(model%pair(i)%master), &
         & i=1, size(model%pair))]
      if (.not. any(named)) named = .true.
      text = ''
      do i = 1, size(model%pair)
         if (.not. named(i) .or. model%pair(i)%master == 0) cycle
         if (len(text) > 0) text = text//'; '
         text = text//'SLAVE='//model%surface(model%pair(i)%slave)%name//', MASTER='// &
            & model%surface(model%pair(i)%master)%name
      end do
      if (len(text) > 0) then
         text = 'pairs are: '//text
      else
         text = 'there is no pair of surfaces'
      end if

   contains

      pure logical function has(surface)
         integer, intent(in) :: surface

         has = is_named(model, output%slave, surface) .or. is_named(model, output%master, surface)
      end function has
   end function pairs_of_request

   subroutine check_materials(model)
      type(model_type), intent(inout) :: model
      integer :: i

      do i = 1, size(model%material)
         if (any(model%section%material == i)) cycle
         call model%log%say(severity%note, 'N0303', 'material `'//model%material(i)%name// &
            & '` is in no section', model%material(i)%at)
      end do
   end subroutine check_materials

   !> A load that should follow an amplitude and does not name it grows along a straight line.
   subroutine check_amplitudes(model, deck)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      character(len=:), allocatable :: word
      type(location_type) :: at
      integer :: i, k
      logical :: found, used

      do i = 1, size(model%amplitude)
         used = .false.
         do k = 1, deck%nblock
            call get_parameter(deck%block(k), 'AMPLITUDE', word, at, found)
            if (found) used = used .or. upper(word) == model%amplitude(i)%name
         end do
         if (used) cycle
         do k = 1, deck%nblock
            if (deck%block(k)%keyword /= 'AMPLITUDE') cycle
            call get_parameter(deck%block(k), 'NAME', word, at, found)
            if (upper(word) == model%amplitude(i)%name) exit
         end do
         call model%log%say(severity%note, 'N0303', 'no load and no motion names amplitude '// &
            & model%amplitude(i)%name, at)
      end do
   end subroutine check_amplitudes
end module lopin_check_unused

!> Options of contact that do nothing where they stand: each is said, none is passed over.
module lopin_check_options
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, location_type, severity
   use lopin_cells, only : cell_type
   use lopin_element_type, only : cells_of_words
   use lopin_facets, only : facets_type, new_facets
   use lopin_surface, only : surface_type, new_surface, update_surface
   use lopin_friction, only : has_friction, bounds_by_area
   use lopin_model, only : model_type, surface_of, overclosure_of, initial_of
   use lopin_block, only : deck_type, block_type, has_parameter
   implicit none
   private
   public :: check_options

   !> Facets curved by less than this share of their size are as they were.
   real(wp), parameter :: unchanged = 1.0e-6_wp

contains

   subroutine check_options(model, deck)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      integer :: pair, k, j

      do k = 1, deck%nblock
         associate (block => deck%block(k))
            if (block%keyword == 'CONTACT CONTROLS') call check_augmented(model, block)
            if (block%keyword /= 'CONTACT PAIR') cycle
            do j = 1, block%nline
               do pair = 1, size(model%pair)
                  if (model%pair(pair)%at%line /= block%line(j)%line) cycle
                  if (model%pair(pair)%at%file /= block%line(j)%file) cycle
                  call check_pair(model, pair, block)
               end do
            end do
         end associate
      end do
   end subroutine check_options

   subroutine check_pair(model, pair, block)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: pair
      type(block_type), intent(in) :: block
      logical :: tied

      associate (p => model%pair(pair))
         tied = p%tied
         if (p%interaction > 0) tied = tied &
            & .or. model%interaction(p%interaction)%overclosure == overclosure_of%tied
         if (p%smooth .and. .not. p%surface_to_surface) call check_smooth(model, pair)
         if (has_parameter(block, 'EXTENSION ZONE') .and. p%surface_to_surface .and. &
            & model%surface(p%master)%kind == surface_of%faces) call idle(model, p%at, &
            & 'EXTENSION ZONE', 'a surface-to-surface pair covers what lies opposite', &
            & 'TYPE=NODE TO SURFACE has an extension')
         if (p%small_sliding .and. any(model%step%nlgeom)) call idle(model, p%at, &
            & 'SMALL SLIDING', 'with NLGEOM contact is followed where it goes', 'leave it out')
         if (p%has_clearance .and. tied) call idle(model, p%at, '*CLEARANCE', 'a tied pair '// &
            & 'bridges its gaps as they are', 'POSITION TOLERANCE or ADJUST= say what is tied')
         if (p%has_clearance .and. .not. tied .and. (p%adjust >= 0.0_wp &
            & .or. allocated(p%adjust_node))) call idle(model, p%at, 'ADJUST', &
            & '*CLEARANCE gives the pair its gap', 'keep one of the two')
         if (tied .and. p%control%initial /= initial_of%automatic) call idle(model, p%at, &
            & 'INITIAL', 'a tied pair bridges its gaps as they are', 'leave it out')
         if (p%interaction == 0) return
         if (.not. tied) call check_areas(model, pair)
         if (.not. tied .or. any(model%pair%before == pair)) return
         if (has_friction(model%interaction(p%interaction)%friction)) call idle(model, p%at, &
            & '*FRICTION', 'a tied pair does not slip', 'leave out TIED, or the friction')
      end associate
   end subroutine check_pair

   !> Bounds of the shear are stresses: on nodes without areas they are forces at each node.
   subroutine check_areas(model, pair)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: pair

      associate (p => model%pair(pair), slave => model%surface(model%pair(pair)%slave))
         if (slave%kind /= surface_of%nodes) return
         if (all(slave%area > 0.0_wp)) return
         if (.not. bounds_by_area(model%interaction(p%interaction)%friction)) return
         call model%log%say(severity%warning, 'W0307', 'surface '//slave%name//' is made of '// &
            & 'nodes without areas, and the friction of interaction '// &
            & model%interaction(p%interaction)%name//' bounds the shear stress: the bound acts '// &
            & 'as a force at each node', p%at, help='TYPE=ELEMENT has areas; or write the area '// &
            & 'of each node under *SURFACE, TYPE=NODE')
      end associate
   end subroutine check_areas

   !> SMOOTH on tools, on faces that are curved by themselves, and where all facets lie in a plane
   !> or meet at edges.
   subroutine check_smooth(model, pair)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: pair
      type(cell_type), allocatable :: cells(:)
      type(facets_type) :: facets
      type(surface_type) :: plain, curved
      type(error_type), allocatable :: error
      integer :: i

      associate (p => model%pair(pair), master => model%surface(model%pair(pair)%master))
         if (master%kind == surface_of%tool .and. model%mesh%ndim == 2) then
            if (.not. any(model%step%nlgeom)) call idle(model, p%at, 'SMOOTH', 'facets of a '// &
               & 'slave are curved where contact is followed on the present shape', &
               & 'NLGEOM on *STEP')
            if (any(model%step%nlgeom)) call check_curved_slave(model, pair)
            return
         end if
         if (master%kind == surface_of%tool) then
            call idle(model, p%at, 'SMOOTH', 'the master is a tool, which has its own shape', &
               & 'leave it out; FILLET RADIUS on *SURFACE rounds the corners of a profile, '// &
               & 'SMOOTH on *SURFACE curves the facets of STL')
            return
         end if
         if (master%kind /= surface_of%faces) return
         call cells_of_words(model%element_word, cells)
         call new_facets(facets, model%mesh, cells, master%element, master%face)
         call new_surface(plain, model%mesh%ndim, facets)
         call update_surface(plain, model%mesh%x, error)
         if (allocated(error)) return
         call new_surface(curved, model%mesh%ndim, facets, smooth=.true.)
         call update_surface(curved, model%mesh%x, error)
         if (allocated(error)) return
         do i = 1, facets%n
            if (any(abs(curved%coefficient(:, :, i) - plain%coefficient(:, :, i)) &
               & > unchanged*plain%size(i))) return
         end do
         call idle(model, p%at, 'SMOOTH', 'the facets of '//master%name//' are flat beside '// &
            & 'each other, meet at more than 30 degrees, or are of second order', 'leave it out')
      end associate
   end subroutine check_smooth

   !> Opposite a profile the facets of the slave are curved, linear ones.
   subroutine check_curved_slave(model, pair)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: pair
      type(cell_type), allocatable :: cells(:)
      type(facets_type) :: facets
      logical, allocatable :: linear(:)

      associate (p => model%pair(pair), slave => model%surface(model%pair(pair)%slave))
         linear = [logical ::]
         if (slave%kind == surface_of%faces) then
            call cells_of_words(model%element_word, cells)
            call new_facets(facets, model%mesh, cells, slave%element, slave%face)
            linear = facets%nnode(:facets%n) == 2
         end if
         if (.not. any(linear)) call idle(model, p%at, 'SMOOTH', 'opposite a profile the '// &
            & 'linear facets of the slave are curved, and '//slave%name//' has none', &
            & 'leave it out')
      end associate
   end subroutine check_curved_slave

   !> Tolerances of a method that no pair has.
   subroutine check_augmented(model, block)
      type(model_type), intent(inout) :: model
      type(block_type), intent(in) :: block
      character(len=*), parameter :: words(3) = [character(len=30) :: &
         & 'RELATIVE PENETRATION TOLERANCE', 'ABSOLUTE PENETRATION TOLERANCE', &
         & 'MAX AUGMENTATIONS']
      integer :: i

      do i = 1, size(model%pair)
         if (model%pair(i)%interaction == 0) cycle
         if (model%interaction(model%pair(i)%interaction)%method%updates()) return
      end do
      do i = 1, size(words)
         if (has_parameter(block, trim(words(i)))) call idle(model, block%at, trim(words(i)), &
            & 'it belongs to AUGMENTED LAGRANGE, which no pair has', 'leave it out, or write '// &
            & '*SURFACE BEHAVIOR, AUGMENTED LAGRANGE')
      end do
   end subroutine check_augmented

   subroutine idle(model, at, word, why, help)
      type(model_type), intent(inout) :: model
      type(location_type), intent(in) :: at
      character(len=*), intent(in) :: word, why, help
      call model%log%say(severity%warning, 'W0305', word//' does nothing here: '//why, at, &
         & help=help)
   end subroutine idle
end module lopin_check_options
